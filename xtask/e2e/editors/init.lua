-- Our package and nothing else, with the built server.
vim.opt.runtimepath:prepend(vim.env.ROOT .. '/editors/nvim')
vim.lsp.config('rtc', { cmd = { vim.env.RTC, 'lsp' } })
vim.env.PATH = vim.fs.dirname(vim.env.RTC) .. ':' .. vim.env.PATH
vim.cmd('syntax on')
vim.cmd('filetype plugin indent on')
