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

" A line without its texts and comments.
function! s:Bare(number) abort
  let line = substitute(getline(a:number), '"\%(\\.\|[^"\\]\)*"', '""', 'g')
  return substitute(line, '//.*\|/\*.\{-}\*/', '', 'g')
endfunction

" Whether a line leaves a bracket open.
function! s:Opens(line) abort
  let open = 0
  for sign in split(substitute(a:line, '[^][(){}]', '', 'g'), '\zs')
    let open = sign =~# '[[({]' ? open + 1 : max([open - 1, 0])
  endfor
  return open > 0
endfunction

" Whether a line goes on with the one before.
function! s:GoesOn(line) abort
  return a:line =~# '^\s*\%(|>\|->\|[*+/<>]\|[=!]=\|\.\a\|\%(and\|or\|to\|then\)\>\|else\>\s*[^ {i]\)'
endfunction

function! RtIndent(number) abort
  let before = prevnonblank(a:number - 1)
  if before == 0
    return 0
  endif
  let [line, last] = [s:Bare(a:number), s:Bare(before)]
  let opens = s:Opens(last)
  let indent = indent(before)
  " Brackets that open on one line count once, and are closed by one line.
  if opens
    let indent += shiftwidth()
  endif
  if line =~# '^\s*[])}]'
    let indent -= shiftwidth()
  endif
  if s:GoesOn(line) && !s:GoesOn(last)
    let indent += shiftwidth()
  elseif s:GoesOn(last) && !s:GoesOn(line) && !opens
    let indent -= shiftwidth()
  endif
  return max([indent, 0])
endfunction
