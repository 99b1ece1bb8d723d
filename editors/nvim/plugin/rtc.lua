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

vim.api.nvim_create_autocmd('LspAttach', {
  desc = 'Tell the live preview of a scene where the cursor is',
  callback = function(attached)
    local server = vim.lsp.get_client_by_id(attached.data.client_id)
    if not server or server.name ~= 'rtc' then
      return
    end
    vim.api.nvim_create_autocmd({ 'CursorMoved', 'CursorHoldI' }, {
      group = vim.api.nvim_create_augroup('rtc-' .. attached.buf, {}),
      buffer = attached.buf,
      callback = function()
        if not server:is_stopped() then
          require('rtc').tell_cursor(server)
        end
      end,
    })
  end,
})
