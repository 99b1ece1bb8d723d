" Our files and nothing else, with the built compiler, in the environment's RTC.
execute 'set runtimepath^=' .. fnameescape($ROOT .. '/editors/vim')
let $PATH = fnamemodify($RTC, ':h') .. ':' .. $PATH
filetype plugin indent on
syntax on
