" Indentation of `.rt` files: two spaces a bracket, and two more for a line that goes on.

if exists('b:did_indent')
  finish
endif
let b:did_indent = 1

setlocal indentexpr=RtIndent(v:lnum)
setlocal indentkeys=0{,0},0),0],!^F,o,O,0=else,0<Bar>
setlocal autoindent
let b:undo_indent = 'setlocal indentexpr< indentkeys< autoindent<'

if exists('*RtIndent')
  finish
endif

" A line without its texts and comments, also of one that goes on below.
function! s:Bare(number) abort
  let line = substitute(getline(a:number), '"\%(\\.\|[^"\\]\)*"', '""', 'g')
  return substitute(line, '//.*\|/\*.\{-}\%(\*/\|$\)', '', 'g')
endfunction

" Whether what stands at a column is in a text or behind `//`.
function! s:Hidden(number, column) abort
  let before = strpart(getline(a:number), 0, a:column - 1)
  return substitute(before, '"\%(\\.\|[^"\\]\)*"', '', 'g') =~# '"\|//'
endfunction

" The line on which the comment begins that a line begins inside of; 0 where it does not. Comments are seldom longer than
" is looked for.
function! s:Comment(number) abort
  call cursor(a:number, 1)
  while 1
    let [line, column] = searchpos('/\*\|\*/', 'bW', max([1, a:number - 100]))
    if line == 0 || getline(line)[column - 1] ==# '*'
      return 0
    elseif !s:Hidden(line, column)
      return line
    endif
  endwhile
endfunction

" Whether a line leaves a bracket open.
function! s:Opens(line) abort
  let open = 0
  for sign in split(substitute(a:line, '[^][(){}]', '', 'g'), '\zs')
    let open = sign =~# '[[({]' ? open + 1 : max([open - 1, 0])
  endfor
  return open > 0
endfunction

" Whether a line goes on with the one before. An `else` that is followed by a body is a statement's.
function! s:GoesOn(line) abort
  return a:line =~# '^\s*\%(|>\|->\|[*+/<>]\|[=!]=\|\.\a\|\%(and\|or\|to\|then\)\>\)'
        \ || a:line =~# '^\s*else\>' && a:line !~# '^\s*else\s*\%(if\>\%(\%(\<then\>\)\@!.\)*\)\={'
endfunction

" The line on which the bracket opens that a line closes first of all; the line itself where it does not begin so.
function! s:Head(number) abort
  if getline(a:number) !~# '^\s*[])}]'
    return a:number
  endif
  call cursor(a:number, indent(a:number) + 1)
  let line = searchpair('[[({]', '', '[])}]', 'bW', {-> s:Hidden(line('.'), col('.'))}, max([1, a:number - 500]))
  return line > 0 ? line : a:number
endfunction

function! RtIndent(number) abort
  " What a comment holds is laid out by who wrote it.
  if s:Comment(a:number) > 0
    return -1
  endif
  let before = prevnonblank(a:number - 1)
  let begun = getline(before) =~# '\*/' ? s:Comment(before) : 0
  if begun > 0
    let before = begun
  endif
  if before == 0
    return 0
  endif
  let [line, last] = [s:Bare(a:number), s:Bare(before)]
  let opens = s:Opens(last)
  let went_on = s:GoesOn(s:Bare(s:Head(before)))
  let indent = indent(before)
  " Brackets that open on one line count once, and are closed by one line.
  if opens
    let indent += shiftwidth()
  endif
  if line =~# '^\s*[])}]'
    let indent -= shiftwidth()
  endif
  if s:GoesOn(line) && !went_on
    let indent += shiftwidth()
  elseif went_on && !s:GoesOn(line) && !opens
    let indent -= shiftwidth()
  endif
  return max([indent, 0])
endfunction
