---The language server of rtc, for `vim.lsp.enable('rtc')`.
---@type vim.lsp.Config
return {
  cmd = { require('rtc').program(), 'lsp' },
  filetypes = { 'rt' },
  root_markers = { '.git' },
}
