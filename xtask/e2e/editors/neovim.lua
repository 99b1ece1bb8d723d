-- Neovim with our package and the built server: what a person does, done by the keys' own functions.
--
-- Usage: nvim --headless -u neovim.lua, in an empty folder, with RTC, ROOT and XDG folders of its own in the environment.

dofile(vim.fs.joinpath(vim.fs.dirname(debug.getinfo(1, 'S').source:sub(2)), 'init.lua'))
local root = vim.env.ROOT

local SCENE = [[
// A ball on a floor.
param size: length = 50cm in 10cm to 1m
material paint = diffuse { color: #d94f30 }
sphere ball { at: (0, size, 0), radius: size, material: paint }
plane {}
light {
  at: (2, 3, 2)m
  power: 60W
}
camera { from: (0, 1, 4)m, look: ball }
]]

local function check(holds, what)
  if not holds then
    error(what, 2)
  end
end

local function wait(what, holds)
  check(vim.wait(20000, holds, 20), 'waited in vain until ' .. what)
end

local function text()
  return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), '\n') .. '\n'
end

---Replaces the first place of a text, as typing does, and puts the cursor there.
local function replace(old, new)
  for number, line in ipairs(vim.api.nvim_buf_get_lines(0, 0, -1, false)) do
    local start = line:find(old, 1, true)
    if start then
      vim.api.nvim_buf_set_text(0, number - 1, start - 1, number - 1, start - 1 + #old, { new })
      vim.api.nvim_win_set_cursor(0, { number, start - 1 })
      return
    end
  end
  error('no ' .. old .. ' in the text')
end

local function to(place)
  replace(place, place)
end

local function open(name, content)
  vim.fn.writefile(vim.split(content:gsub('\n$', ''), '\n'), name)
  vim.cmd.edit(name)
end

local function client()
  return vim.lsp.get_clients({ bufnr = 0, name = 'rtc' })[1]
end

---Asks as often as the document changes meanwhile: Neovim tells of what was typed a moment later.
local function request(method, more)
  local asked = vim.lsp.util.make_position_params(0, client().offset_encoding)
  local answer
  wait(method .. ' is answered', function()
    answer = client():request_sync(method, vim.tbl_extend('force', asked, more or {}), 20000, 0)
    return not (answer and answer.err and answer.err.code == vim.lsp.protocol.ErrorCodes.ContentModified)
  end)
  check(answer and not answer.err, method .. ': ' .. vim.inspect(answer))
  return answer.result
end

local function group_at(line, column)
  return vim.fn.synIDattr(vim.fn.synID(line, column, 1), 'name')
end

local steps = {}
local function step(name, run)
  table.insert(steps, { name, run })
end

step('the syntax file colours where there is no parser', function()
  open('plain.rt', SCENE)
  check(vim.bo.filetype == 'rt', 'the filetype is ' .. vim.bo.filetype)
  check(vim.b.current_syntax == 'rt' and not vim.treesitter.highlighter.active[vim.fn.bufnr()], 'the syntax file colours')
  local wanted = { { 1, 4, 'rtComment' }, { 2, 1, 'rtKeyword' }, { 2, 13, 'rtType' }, { 2, 22, 'rtNumber' } }
  vim.list_extend(wanted, { { 3, 18, 'rtKind' }, { 3, 28, 'rtField' }, { 3, 35, 'rtColor' }, { 4, 1, 'rtKind' } })
  for _, place in ipairs(wanted) do
    local found = group_at(place[1], place[2])
    check(found == place[3], ('%d:%d is %s, not %s'):format(place[1], place[2], found, place[3]))
  end
end)

step('what is laid out is indented so', function()
  local garden = table.concat(vim.fn.readfile(root .. '/examples/garden/garden.rt'), '\n') .. '\n'
  open('garden-copy.rt', garden)
  vim.cmd('silent %left | silent normal! gg=G')
  check(text() == garden, 'garden.rt is indented otherwise:\n' .. vim.diff(garden, text()))
  vim.cmd('bwipeout!')
end)

step('what a comment holds stays where it is', function()
  local noted = 'sphere {\n  /* a\n     b */\n  radius: 1m // /* c\n}\nlet a = 4\n  / 2\n/*\n * d\n    */\nplane {\n}\n'
  open('noted.rt', noted)
  vim.cmd('silent normal! gg=G')
  check(text() == noted, 'the comments are indented otherwise:\n' .. vim.diff(noted, text()))
  vim.cmd('bwipeout!')
end)

step('the parser compiles, colours and folds', function()
  check(require('rtc').install_parser(), 'the parser compiles')
  open('scene.rt', SCENE)
  check(vim.treesitter.highlighter.active[vim.fn.bufnr()], 'tree-sitter colours')
  local captures = vim.tbl_map(function(found)
    return found.capture
  end, vim.treesitter.get_captures_at_pos(0, 3, 1))
  check(vim.tbl_contains(captures, 'type.builtin'), 'sphere is ' .. vim.inspect(captures))
  check(vim.wo.foldexpr:find('treesitter'), 'tree-sitter folds')
end)

step('messages appear and go', function()
  wait('the server is there', client)
  replace('radius: size', 'radius: 8deg')
  wait('the slip is told', function()
    return #vim.diagnostic.get(0) > 0
  end)
  local found = vim.diagnostic.get(0)[1]
  check(found.code == 'E0203' and found.lnum == 3, vim.inspect(found))
  replace('8deg', 'size')
  wait('the message goes', function()
    return #vim.diagnostic.get(0) == 0
  end)
end)

step('a fix is offered and applied', function()
  replace('color: #d94f30', 'colour = #d94f30')
  wait('the slip is told', function()
    return #vim.diagnostic.get(0) > 0
  end)
  replace('colour = #d94f30', 'color = #d94f30')
  wait('the sign is told', function()
    local found = vim.diagnostic.get(0)
    return #found == 1 and found[1].code == 'E0003'
  end)
  to('= #d94f30')
  vim.lsp.buf.code_action({
    apply = true,
    filter = function(action)
      return action.kind == 'quickfix' and not action.title:lower():find('allow')
    end,
  })
  wait('the fix is made', function()
    return text():find('color: #d94f30', 1, true)
  end)
  wait('the message goes', function()
    return #vim.diagnostic.get(0) == 0
  end)
end)

step('completion knows fields, in a broken statement too', function()
  replace('plane {}', 'plane { no')
  local behind = { line = 4, character = 10 }
  wait('a field is offered', function()
    local answer = request('textDocument/completion', { position = behind, context = { triggerKind = 1 } })
    return vim.iter(answer.items or answer):any(function(item)
      return item.label == 'normal'
    end)
  end)
  check(vim.bo.omnifunc == 'v:lua.vim.lsp.omnifunc', 'CTRL-X CTRL-O asks the server')
  replace('plane { no', 'plane {}')
end)

step('hover tells what is there', function()
  to('radius')
  vim.lsp.buf.hover()
  local shown
  wait('the window opens', function()
    for _, window in ipairs(vim.api.nvim_list_wins()) do
      if vim.api.nvim_win_get_config(window).relative ~= '' then
        shown = table.concat(vim.api.nvim_buf_get_lines(vim.api.nvim_win_get_buf(window), 0, -1, false), '\n')
        vim.api.nvim_win_close(window, true)
        return true
      end
    end
  end)
  check(shown:find('length'), shown)
end)

step('definitions are found', function()
  to('paint }')
  vim.lsp.buf.definition()
  wait('the cursor moves', function()
    return vim.api.nvim_win_get_cursor(0)[1] == 3
  end)
end)

step('renaming reaches every use', function()
  to('paint =')
  vim.lsp.buf.rename('clay')
  wait('both places have the name', function()
    return text():find('material clay = ', 1, true) and text():find('material: clay }', 1, true)
  end)
end)

step('the text is laid out', function()
  replace('plane {}', 'plane   {  }')
  vim.lsp.buf.format({ timeout_ms = 20000 })
  wait('it is laid out', function()
    return text():find('\nplane {}\n', 1, true)
  end)
end)

step('symbols, tokens, colours, folds and hints are there', function()
  local document = { textDocument = { uri = vim.uri_from_bufnr(0) } }
  check(#request('textDocument/documentSymbol', document) >= 5, 'the things of the file are listed')
  check(#request('textDocument/semanticTokens/full', document).data > 50, 'words have their kinds')
  check(#request('textDocument/documentColor', document) == 1, 'the colour is seen')
  check(#request('textDocument/foldingRange', document) >= 1, 'something can be folded')
  check(#request('textDocument/codeLens', document) >= 1, 'something is offered above the camera')
  local all = { start = { line = 0, character = 0 }, ['end'] = { line = 9, character = 0 } }
  local hints = request('textDocument/inlayHint', vim.tbl_extend('error', document, { range = all }))
  check(#hints >= 1 and hints[1].label:find('50, 0)cm', 1, true), 'what the centre comes to is said')
end)

step('the live preview serves the text, saved or not', function()
  local pages = {}
  vim.ui.open = function(page)
    table.insert(pages, page)
    local done = { code = 0 }
    return { wait = function() return done end }
  end
  vim.cmd.RtcPreview()
  wait('the page opens', function()
    return pages[1]
  end)
  check(pages[1]:find('^http://127%.0%.0%.1:%d+/%w+/$'), pages[1])

  -- The same by what stands above the camera, which is clicked on.
  to('camera {')
  vim.lsp.codelens.refresh({ bufnr = 0 })
  wait('something stands above the camera', function()
    return vim.iter(vim.lsp.codelens.get(0)):any(function(lens)
      return lens.range.start.line == 9
    end)
  end)
  vim.ui.select = function(offered, about, choose)
    for number, one in ipairs(offered) do
      if about.format_item(one):lower():find('preview') then
        return choose(one, number)
      end
    end
    error('no preview among ' .. vim.inspect(offered))
  end
  vim.lsp.codelens.run()
  wait('the page opens', function()
    return pages[2]
  end)
  check(pages[2]:find('^http://127%.0%.0%.1:%d+/%w+/$'), pages[2])
end)

step('what is written on the page goes into the text, saved or not', function()
  open('written.rt', SCENE .. 'render { size: (64, 48), samples: 4 }\n')
  wait('the server is there', client)
  replace('power: 60W', 'power: 80W')
  -- What follows is undone by itself.
  vim.bo.undolevels = vim.bo.undolevels
  local page
  vim.ui.open = function(opened)
    page = opened
    return { wait = function() return { code = 0 } end }
  end
  vim.cmd.RtcPreview()
  wait('the page opens', function()
    return page
  end)
  local function write(value)
    local script = root .. '/xtask/e2e/editors/write.mjs'
    local done
    vim.system({ 'node', script, vim.env.RTC, vim.env.PLAYWRIGHT, page, 'size', value }, { text = true }, function(ended)
      done = ended
    end)
    -- A browser starts, which takes its time.
    check(vim.wait(120000, function() return done end, 20), 'waited in vain until the page has written')
    return done.code == 0, done.stdout .. done.stderr
  end
  local written, said = write('75cm')
  check(written, said)
  check(text():find('size: length = 75cm in', 1, true) and text():find('80W', 1, true), text())
  local file = table.concat(vim.fn.readfile('written.rt'), '\n')
  check(vim.bo.modified and file:find('= 50cm', 1, true) and file:find('60W', 1, true), 'the file is as it was: ' .. file)
  vim.cmd('silent undo')
  check(text():find('size: length = 50cm in', 1, true) and text():find('80W', 1, true), 'it is undone: ' .. text())
  vim.bo.modifiable = false
  written, said = write('30cm')
  check(not written and said:find('the editor does not take it', 1, true), said)
  vim.bo.modifiable = true
  vim.cmd('bwipeout!')
end)

step(':make fills the list of errors', function()
  open('wrong.rt', 'sphere { radius: 8deg }\n')
  vim.cmd('silent make!')
  local found = vim.fn.getqflist()
  check(#found == 1 and found[1].lnum == 1 and found[1].col == 18 and found[1].nr == 203, vim.inspect(found))
end)

step('the help is found', function()
  vim.cmd('helptags ' .. vim.fn.fnameescape(root .. '/editors/nvim/doc'))
  vim.cmd('help :RtcPreview')
  check(vim.fn.expand('%:t') == 'rtc.txt', 'the help of our package opens')
  vim.fn.delete(root .. '/editors/nvim/doc/tags')
end)

vim.api.nvim_create_autocmd('VimEnter', {
  callback = vim.schedule_wrap(function()
    local only = vim.env.ONLY
    for _, it in ipairs(steps) do
      if not only or it[1]:find(only, 1, true) then
        local fine, why = xpcall(it[2], debug.traceback)
        io.stdout:write(('  neovim: %s%s\n'):format(it[1], fine and '' or ': FAILED\n' .. why))
        if not fine then
          io.stdout:write(vim.fn.execute('messages') .. '\n')
          vim.cmd('cquit 1')
        end
      end
    end
    vim.cmd('qall!')
  end),
})
