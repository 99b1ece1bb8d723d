-- Settings for `.rt` files, scenes of rtc.

if vim.b.did_ftplugin then
  return
end
vim.b.did_ftplugin = true

local options = vim.opt_local
options.comments = 's1:/*,mb:*,ex:*/,:///,://'
options.commentstring = '// %s'
options.formatoptions:remove('t')
options.formatoptions:append('croql')
options.expandtab = true
options.shiftwidth = 2
options.softtabstop = 2
options.suffixesadd = '.rt'
vim.b.undo_ftplugin = 'setlocal comments< commentstring< formatoptions< expandtab< shiftwidth< softtabstop<'
  .. ' suffixesadd<'

if not vim.b.current_compiler then
  vim.cmd.compiler('rtc')
end

-- With its parser tree-sitter colours and folds; without it syntax/rt.vim does.
if require('rtc').start_parser(vim.api.nvim_get_current_buf()) then
  vim.b.undo_ftplugin = vim.b.undo_ftplugin
    .. ' foldmethod< foldexpr< foldenable< | lua pcall(vim.treesitter.stop)'
end

vim.api.nvim_buf_create_user_command(0, 'RtcPreview', function()
  require('rtc').preview()
end, { desc = 'Open the live preview of this scene' })
vim.api.nvim_buf_create_user_command(0, 'RtcBuild', function()
  require('rtc').build()
end, { desc = 'Render this scene beside its file' })
