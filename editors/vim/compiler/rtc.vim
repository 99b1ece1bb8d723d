" `:make` checks the scene, and fills the list of errors.

if exists('current_compiler')
  finish
endif
let current_compiler = 'rtc'

let s:make = shellescape(get(g:, 'rtc_program', 'rtc'), 1) . ' check --message-format short %:S'
execute 'CompilerSet makeprg=' . escape(s:make, ' |"\')
CompilerSet errorformat=%f:%l:%c:\ %trror[E%n]:\ %m,%f:%l:%c:\ %tarning[W%n]:\ %m,%-G%.%#
