" What `gq` does in scenes: `rtc fmt` lays out the lines that are meant, in the whole text.

function! s:Tell(what) abort
  echohl WarningMsg
  echomsg 'rtc: ' .. a:what
  echohl None
endfunction

" What a program makes of lines, and what it ends with. No shell comes between, and what it reports is left out.
function! s:Through(command, lines) abort
  let [given, made] = [tempname(), tempname()]
  call writefile(a:lines, given)
  let files = {'in_io': 'file', 'in_name': given, 'out_io': 'file', 'out_name': made, 'err_io': 'null'}
  try
    let job = job_start(a:command, files)
    while job_status(job) ==# 'run'
      sleep 5m
    endwhile
    return [filereadable(made) ? readfile(made) : [], job_info(job).exitval]
  finally
    call delete(given)
    call delete(made)
  endtry
endfunction

" For 'formatexpr'.
function! rtc#Format() abort
  " A line that grows too long while it is typed is broken by Vim.
  if mode() =~# '[iR]'
    return 1
  endif
  let program = get(g:, 'rtc_program', 'rtc')
  if !executable(program)
    call s:Tell('there is no program ' .. program)
    return 0
  endif
  let meant = printf('--lines=%d:%d', v:lnum, v:lnum + v:count - 1)
  let [made, code] = s:Through([program, 'fmt', meant, '-'], getline(1, '$'))
  if code < 0 || code > 1 || empty(made)
    call s:Tell('the scene cannot be laid out')
    return 0
  endif
  " Lines that stay keep their marks.
  let [old, new] = [line('$'), len(made)]
  let head = 0
  while head < min([old, new]) && getline(head + 1) ==# made[head]
    let head += 1
  endwhile
  let tail = 0
  while tail < min([old, new]) - head && getline(old - tail) ==# made[new - tail - 1]
    let tail += 1
  endwhile
  let shared = min([old, new]) - head - tail
  if shared > 0
    call setline(head + 1, made[head : head + shared - 1])
  endif
  if new > old
    call append(head + shared, made[head + shared : new - tail - 1])
  elseif new < old
    silent call deletebufline('%', head + shared + 1, old - tail)
  endif
  if code == 1
    call s:Tell('what has errors stays as it is; `:make` lists them')
  endif
  return 0
endfunction
