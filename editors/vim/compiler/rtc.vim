" `:make` checks the scene, and fills the list of errors.

if exists('current_compiler')
  finish
endif
let current_compiler = 'rtc'

CompilerSet makeprg=rtc\ check\ --message-format\ short\ %:S
CompilerSet errorformat=%f:%l:%c:\ %trror[E%n]:\ %m,%f:%l:%c:\ %tarning[W%n]:\ %m,%-G%.%#
