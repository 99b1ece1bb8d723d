" What a person does in Vim with our files: colours, indentation, layout and :make.
"
" Usage: vim -Nu NONE -i NONE -es -S vim.vim, in an empty folder, with RTC and ROOT in the environment.

execute 'source' fnameescape(expand('<sfile>:h') .. '/init.vim')

function Check(holds, what)
  if !a:holds
    throw a:what
  endif
endfunction

function Tell(what)
  " Vim itself says nothing in batch, and what it writes to /dev/stdout is lost where that is a file.
  execute 'silent !echo' shellescape('  vim: ' .. a:what, 1)
endfunction

function Run()
  call writefile([
    \ '// A ball on a floor.',
    \ 'param size: length = 50cm in 10cm to 1m',
    \ 'material paint = diffuse { color: #d94f30 }',
    \ 'sphere ball { at: (0, size, 0), radius: size, material: paint }',
    \ ], 'scene.rt')
  edit scene.rt
  call Check(&filetype == 'rt', 'the filetype is ' .. &filetype)
  for [line, column, group] in [
    \ [1, 4, 'rtComment'], [2, 1, 'rtKeyword'], [2, 13, 'rtType'], [2, 22, 'rtNumber'],
    \ [3, 18, 'rtKind'], [3, 28, 'rtField'], [3, 35, 'rtColor'], [4, 1, 'rtKind'],
    \ ]
    let found = synIDattr(synID(line, column, 1), 'name')
    call Check(found == group, printf('%d:%d is %s, not %s', line, column, found, group))
  endfor
  call Tell('words have their colours')

  let written = readfile($ROOT .. '/examples/garden/garden.rt')
  edit garden.rt
  call setline(1, written)
  %left
  normal! gg=G
  call Check(getline(1, '$') == written, "garden.rt is indented otherwise:\n" .. join(getline(1, '$'), "\n"))
  bwipeout!
  call Tell('what is laid out is indented so')

  call writefile(['plane   {  }'], 'plain.rt')
  edit plain.rt
  normal! gggqG
  call Check(getline(1, '$') == ['plane {}'], 'gq gives ' .. join(getline(1, '$'), "\n"))
  call Tell('gq lays out')
  bwipeout!

  call writefile(['sphere { radius: 8deg }'], 'wrong.rt')
  edit wrong.rt
  set shellpipe=>%s\ 2>&1
  silent make!
  let found = getqflist()
  call Check(len(found) == 1 && found[0].lnum == 1 && found[0].col == 18 && found[0].nr == 203, string(found))
  call Tell(':make fills the list of errors')
endfunction

try
  call Run()
catch
  call Tell('FAILED: ' .. v:exception .. ' in ' .. v:throwpoint)
  cquit
endtry
qall!
