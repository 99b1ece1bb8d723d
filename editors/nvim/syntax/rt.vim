" Colours of `.rt` files, scenes of rtc. What stands further down goes before what is above it.

if exists('b:current_syntax')
  finish
endif

syntax case match

syntax keyword rtKeyword let param assert fn
syntax keyword rtConditional if then else
syntax keyword rtRepeat for
syntax keyword rtWordOperator and or not
syntax keyword rtInclude import
syntax keyword rtBoolean true false
syntax match rtKeyword "\<\%(material\|part\)\>"
syntax match rtWordOperator "\<to\>"
syntax match rtRepeat "\<in\>"
syntax match rtInclude "\<as\>"

" made from: colours, between \%( and \), joined by \|
syntax match rtConstant "\<\%(black\|white\|gray\|grey\|silver\|red\|green\|blue\|yellow\|cyan\|magenta\|orange\|purple\|brown\|pink\)\>"
" made from: words, between \%( and \), joined by \|
syntax match rtConstant ":\s*\zs\%(agx\|auto\|box\|gaussian\|mitchell\|neutral\|none\|sky\|tent\|transparent\)\>"
" made from: types, between \<\%( and \), joined by \|
syntax match rtType "\%(:\|->\)\s*\[*\zs\<\%(number\|int\|bool\|text\|color\|texture\|material\|thing\|transform\|point\|vector\|length\|angle\|power\|radiance\|temperature\|area\)\>\ze\]*\s*\%(=\|,\|)\)"
syntax match rtFunction "\<\h\w*\>\ze("
" made from: functions, between \%( and \), joined by \|
syntax match rtBuiltin "\<\%(sin\|cos\|tan\|asin\|acos\|atan2\|sqrt\|abs\|min\|max\|clamp\|mix\|floor\|ceil\|round\|mod\|pow\|exp\|log\|length\|normalize\|dot\|cross\|range\|linspace\|rand\|bounds\|rgb\|srgb\|hsv\|blackbody\|checker\|stripes\|noise\|image\|table\|scale\|turn\|move\|matrix\)\>\ze("
syntax match rtThing "\<\h\w*\%(\.\h\w*\)*\>\ze\%(\s\+\h\w*\)\=\s*{"
" made from: kinds, between \%( and \), joined by \|
syntax match rtKind "\<\%(sphere\|hyperboloid\|paraboloid\|cone\|cylinder\|disk\|box\|mesh\|plane\|group\|diffuse\|mirror\|dielectric\|metal\|plastic\|emitter\|light\|sun\|sky\|camera\|lens\|render\)\>\ze\%(\s\+\h\w*\)\=\s*{"
syntax match rtName "\%(\<\%(let\|material\|param\|part\|fn\)\s\+\)\@<=\h\w*\>"
syntax match rtConditional "\<else\>"
syntax match rtField "\<\h\w*\>\ze\s*:"
syntax match rtMark "@\h\w*"

syntax match rtSign "|>\|->\|[-+*/=<>!]=\=\|[=<>!]="
" A number with the unit that touches it; behind / only units go on.
" made from: units, between \%(\%( and \)\d, joined by \|
syntax match rtNumber "\<\d[0-9_]*\%(\.\d[0-9_]*\)\=\%([eE][+-]\=\d\+\)\=\%(%\|\a\w*\%(/\%(\%(nm\|um\|mm\|cm\|m\|km\|in\|ft\|deg\|rad\|turn\|mW\|W\|kW\|K\)\d\=\>\)\)*\)\="
syntax match rtUnit ")\zs\%(%\|\a\w*\)"
syntax match rtColor "#\%(\x\{6}\|\x\{3}\)\>"

syntax match rtEscape contained +\\["\\nt]+
syntax region rtText start=+"+ skip=+\\.+ end=+"+ oneline contains=rtEscape

syntax keyword rtTodo contained TODO FIXME NOTE XXX
syntax match rtComment "//.*" contains=rtTodo,@Spell
syntax match rtDoc "^\s*///\%([^/].*\)\=$" contains=rtTodo,@Spell
syntax region rtComment start="/\*" end="\*/" contains=rtTodo,@Spell

syntax region rtBody matchgroup=rtBrace start="{" end="}" transparent fold
syntax sync minlines=200

highlight default link rtKeyword Keyword
highlight default link rtConditional Conditional
highlight default link rtRepeat Repeat
highlight default link rtWordOperator Operator
highlight default link rtSign Operator
highlight default link rtInclude Include
highlight default link rtBoolean Boolean
highlight default link rtConstant Constant
highlight default link rtType Type
highlight default link rtThing Structure
highlight default link rtKind Type
highlight default link rtFunction Function
highlight default link rtBuiltin Function
highlight default link rtField Identifier
highlight default link rtName Identifier
highlight default link rtMark PreProc
highlight default link rtNumber Number
highlight default link rtUnit Number
highlight default link rtColor Constant
highlight default link rtText String
highlight default link rtEscape SpecialChar
highlight default link rtTodo Todo
highlight default link rtComment Comment
highlight default link rtDoc SpecialComment
highlight default link rtBrace Delimiter

let b:current_syntax = 'rt'
