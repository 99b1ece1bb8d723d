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

  for scene in glob($ROOT .. '/examples/**/*.rt', 0, 1)
    let written = readfile(scene)
    edit indented.rt
    call setline(1, written)
    %left
    normal! gg=G
    call Check(getline(1, '$') == written, scene .. " is indented otherwise:\n" .. join(getline(1, '$'), "\n"))
    bwipeout!
  endfor
  call Tell('what is laid out is indented so')

  let loose = ['// A ball.', 'group {', '    sphere{radius:1m}', '    plane{}', '}', '', '', 'let a=1']
  for [written, typed, wanted] in [
    \ [loose, 'gggqG', ['// A ball.', 'group {', '  sphere { radius: 1m }', '  plane {}', '}', '', 'let a = 1']],
    \ [loose, '3Ggqq', loose[:1] + ['  sphere { radius: 1m }'] + loose[3:]],
    \ [loose, '4Ggqj', loose[:2] + ['  plane {}'] + loose[4:]],
    \ [loose, 'Ggqq', loose[:5] + ['let a = 1']],
    \ [loose, '2Ggqq', loose],
    \ [['plane   {'], 'gggqG', ['plane   {']],
    \ [['plane{}', 'plane   { a b }'], 'gggqG', ['plane {}', 'plane   { a b }']],
    \ [['plane { normal: (1,', '  0, 0) }', 'let a=1'], 'ggVgq', ['plane { normal: (1, 0, 0) }', 'let a=1']],
    \ [[''], 'gqq', ['']],
    \ ]
    call writefile(written, 'loose.rt')
    edit! loose.rt
    execute 'silent normal!' typed
    call Check(getline(1, '$') == wanted, typed .. " gives\n" .. join(getline(1, '$'), "\n"))
    bwipeout!
  endfor
  call Tell('gq lays out the lines that are meant, and leaves what is broken')

  call writefile(['sphere { radius: 8deg }'], 'wrong.rt')
  edit wrong.rt
  set shellpipe=>%s\ 2>&1
  silent make!
  let found = getqflist()
  call Check(len(found) == 1 && found[0].lnum == 1 && found[0].col == 18 && found[0].nr == 203, string(found))
  bwipeout!
  call Tell(':make fills the list of errors')

  " A program of one's own, on a path that a shell would take apart.
  let g:rtc_program = getcwd() .. "/it's 100% (mine)/rtc"
  call mkdir(fnamemodify(g:rtc_program, ':h'))
  call system('ln -s ' .. shellescape($RTC) .. ' ' .. shellescape(g:rtc_program))
  let $PATH = '/usr/bin:/bin'
  edit wrong.rt
  call setqflist([])
  silent make!
  call Check(len(getqflist()) == 1 && getqflist()[0].nr == 203, string(getqflist()))
  call setline(1, 'plane{}')
  silent normal! gqq
  call Check(getline(1) == 'plane {}', 'gq gives ' .. getline(1))
  call Tell('another program is taken where one is named')
endfunction

try
  call Run()
catch
  call Tell('FAILED: ' .. v:exception .. ' in ' .. v:throwpoint)
  cquit
endtry
qall!
