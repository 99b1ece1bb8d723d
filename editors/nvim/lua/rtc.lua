---What the commands for scenes do: |rtc.txt|.
local M = {}

---The language server of a buffer, with a message where there is none.
---@param buffer integer
---@return vim.lsp.Client?
local function client(buffer)
  local found = vim.lsp.get_clients({ bufnr = buffer, name = 'rtc' })[1]
  if not found then
    vim.notify('rtc: the language server is not running; is `rtc` on the path?', vim.log.levels.ERROR)
  end
  return found
end

---Opens the live preview of a buffer's text, saved or not.
---@param buffer? integer
function M.preview(buffer)
  buffer = buffer or vim.api.nvim_get_current_buf()
  local server = client(buffer)
  if not server then
    return
  end
  local asked = { command = 'rtc.startPreview', arguments = { { uri = vim.uri_from_bufnr(buffer) } } }
  -- The server asks for the page to be opened once it is served.
  server:request('workspace/executeCommand', asked, function(error)
    if error then
      vim.notify('rtc: no preview: ' .. error.message, vim.log.levels.ERROR)
    end
  end, buffer)
end

---Tells the server where the cursor is: the preview lights up what stands there.
---@param server vim.lsp.Client
function M.tell_cursor(server)
  server:notify('rtc/cursor', vim.lsp.util.make_position_params(0, server.offset_encoding))
end

---Renders the file of a buffer, and says where the picture is.
---@param buffer? integer
function M.build(buffer)
  local file = vim.api.nvim_buf_get_name(buffer or 0)
  vim.cmd.update()
  vim.notify('rtc: rendering ' .. vim.fs.basename(file))
  vim.system({ M.program(), 'build', file }, { text = true }, function(done)
    vim.schedule(function()
      local level = done.code == 0 and vim.log.levels.INFO or vim.log.levels.ERROR
      vim.notify(vim.trim(done.stderr .. done.stdout), level)
    end)
  end)
end

---The program `rtc`: |g:rtc_program|.
---@return string
function M.program()
  return vim.g.rtc_program or 'rtc'
end

---Colours and folds a buffer by tree-sitter, where its parser is there.
---@param buffer integer
---@return boolean
function M.start_parser(buffer)
  if not pcall(vim.treesitter.start, buffer, 'rt') then
    return false
  end
  for _, window in ipairs(vim.fn.win_findbuf(buffer)) do
    local options = vim.wo[window][0]
    options.foldmethod = 'expr'
    options.foldexpr = 'v:lua.vim.treesitter.foldexpr()'
    options.foldenable = false
  end
  return true
end

---Compiles the parser of the grammar in a folder to where Neovim finds it.
---@param folder? string where grammar.js is; by default beside this package
---@return boolean
function M.install_parser(folder)
  local here = vim.fs.dirname(vim.fs.dirname(vim.fs.dirname(debug.getinfo(1, 'S').source:sub(2))))
  local source = vim.fs.joinpath(vim.fs.normalize(folder or vim.fs.joinpath(here, 'tree-sitter-rt')), 'src')
  local target = vim.fs.joinpath(vim.fn.stdpath('data'), 'site', 'parser')
  local parser = vim.fs.joinpath(target, 'rt.so')
  -- What is loaded is neither loaded again nor written over.
  local _, is_loaded = pcall(vim.treesitter.language.add, 'rt')
  local fresh = parser .. '.new'
  vim.fn.mkdir(target, 'p')
  local command = { vim.env.CC or 'cc', '-shared', '-fPIC', '-O2', '-I' .. source }
  vim.list_extend(command, { vim.fs.joinpath(source, 'parser.c'), vim.fs.joinpath(source, 'scanner.c'), '-o', fresh })
  local starts, done = pcall(function()
    return vim.system(command, { text = true }):wait()
  end)
  local why = not starts and done or done.code ~= 0 and done.stderr
  if not why then
    why = select(2, vim.uv.fs_rename(fresh, parser))
  end
  if why then
    vim.notify('rtc: the parser does not compile: ' .. why, vim.log.levels.ERROR)
    return false
  end
  if is_loaded == true then
    vim.notify('rtc: the parser is ' .. parser .. ', from the next start of Neovim on')
    return true
  end
  vim.treesitter.language.add('rt', { path = parser })
  for _, buffer in ipairs(vim.api.nvim_list_bufs()) do
    if vim.bo[buffer].filetype == 'rt' then
      M.start_parser(buffer)
    end
  end
  vim.notify('rtc: the parser is ' .. parser)
  return true
end

return M
