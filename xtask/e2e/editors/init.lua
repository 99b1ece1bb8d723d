-- Our package and nothing else, with the built server.
vim.opt.runtimepath:append(vim.env.ROOT .. '/editors/nvim')
vim.g.rtc_program = vim.env.RTC
vim.cmd('syntax on')
vim.cmd('filetype plugin indent on')
