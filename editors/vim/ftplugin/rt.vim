" Settings for `.rt` files, scenes of rtc.

if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1

setlocal comments=s1:/*,mb:*,ex:*/,:///,://
setlocal commentstring=//\ %s
setlocal formatoptions-=t formatoptions+=croql
setlocal expandtab shiftwidth=2 softtabstop=2
setlocal suffixesadd=.rt
setlocal include=^\\s*import\\s*\"\\zs[^\"]*
setlocal define=^\\s*\\%(let\\\|material\\\|param\\\|part\\\|fn\\)\\s
let b:undo_ftplugin = 'setlocal comments< commentstring< formatoptions< expandtab< shiftwidth< softtabstop<'
      \ . ' suffixesadd< include< define<'

if has('job')
  setlocal formatexpr=rtc#Format()
  let b:undo_ftplugin .= ' formatexpr<'
endif

if !exists('b:current_compiler')
  compiler rtc
endif
