autocmd BufNewFile,BufRead *.rt setfiletype rt
