-- Starts the language server for scenes, unless `vim.g.rtc_lsp` is false.

if vim.g.loaded_rtc then
  return
end
vim.g.loaded_rtc = true

if vim.g.rtc_lsp ~= false and vim.lsp.enable then
  vim.lsp.enable('rtc')
  -- Where init.lua says `syntax on`, the first file has its type before this is read.
  vim.api.nvim_create_autocmd('VimEnter', {
    once = true,
    callback = function()
      vim.lsp.enable('rtc')
    end,
  })
end

vim.api.nvim_create_user_command('RtcParser', function(arguments)
  require('rtc').install_parser(arguments.args ~= '' and arguments.args or nil)
end, { nargs = '?', complete = 'dir', desc = 'Compile the tree-sitter parser for .rt files' })

-- What a code lens asks for: the answer is the address of a page.
vim.lsp.commands['rtc.startPreview'] = function(command, context)
  local server = vim.lsp.get_client_by_id(context.client_id)
  if server then
    require('rtc').start_preview(server, command.arguments[1])
  end
end
