; What is behind in this file goes before what is above it.

(comment) @comment
(doc_comment) @comment.documentation

; --- Names ----------------------------------------------------------------------------------------------------

(identifier) @variable

((identifier) @constant.builtin
  ; made from: colours, between builtin " and "), joined by " "
  (#any-of? @constant.builtin "black" "white" "gray" "grey" "silver" "red" "green" "blue" "yellow" "cyan" "magenta" "orange" "purple" "brown" "pink"))

(field
  value: (identifier) @constant.builtin
  ; made from: words, between builtin " and "), joined by " "
  (#any-of? @constant.builtin "agx" "auto" "box" "gaussian" "mitchell" "neutral" "none" "sky" "tent" "transparent"))

(path
  member: (identifier) @variable.member)
(member
  member: (identifier) @variable.member)
(field
  name: (identifier) @variable.member)
(argument
  name: (identifier) @variable.parameter)
(parameter
  name: (identifier) @variable.parameter)
(param
  name: (identifier) @variable.parameter)

(definition
  name: (identifier) @variable)
(thing
  name: (identifier) @variable)
(import
  name: (identifier) @module)
(part
  name: (identifier) @type)
(function
  name: (identifier) @function)

(call
  function: (identifier) @function.call)
(call
  function: (path
    member: (identifier) @function.call .))
(call
  function: (identifier) @function.builtin
  ; made from: functions, between builtin " and "), joined by " "
  (#any-of? @function.builtin "sin" "cos" "tan" "asin" "acos" "atan2" "sqrt" "abs" "min" "max" "clamp" "mix" "floor" "ceil" "round" "mod" "pow" "exp" "log" "length" "normalize" "dot" "cross" "range" "linspace" "rand" "bounds" "rgb" "srgb" "hsv" "blackbody" "checker" "stripes" "noise" "image" "table" "scale" "turn" "move" "matrix"))

(thing
  kind: (identifier) @type)
(construct
  kind: (identifier) @type)
(thing
  kind: (path
    member: (identifier) @type .))
(construct
  kind: (path
    member: (identifier) @type .))
(thing
  kind: (identifier) @type.builtin
  ; made from: kinds, between builtin " and "), joined by " "
  (#any-of? @type.builtin "sphere" "hyperboloid" "paraboloid" "cone" "cylinder" "disk" "box" "mesh" "plane" "group" "diffuse" "mirror" "dielectric" "metal" "plastic" "emitter" "light" "sun" "sky" "camera" "lens" "render"))
(construct
  kind: (identifier) @type.builtin
  ; made from: kinds, between builtin " and "), joined by " "
  (#any-of? @type.builtin "sphere" "hyperboloid" "paraboloid" "cone" "cylinder" "disk" "box" "mesh" "plane" "group" "diffuse" "mirror" "dielectric" "metal" "plastic" "emitter" "light" "sun" "sky" "camera" "lens" "render"))

(type
  (identifier) @type.builtin)
(type
  "material" @type.builtin)

(mark
  "@" @attribute
  name: (identifier) @attribute)

; --- Literals -------------------------------------------------------------------------------------------------

(number) @number
(unit) @number.unit
(color) @constant
(boolean) @boolean
(text) @string
(escape) @string.escape

; --- Words and signs ------------------------------------------------------------------------------------------

(definition
  keyword: _ @keyword)
[
  "param"
  "part"
  "assert"
] @keyword
"fn" @keyword.function
[
  "import"
  "as"
] @keyword.import
(for_statement
  [
    "for"
    "in"
  ] @keyword.repeat)
(param
  "in" @keyword)
[
  "if"
  "then"
  "else"
] @keyword.conditional
[
  "and"
  "or"
  "not"
  "to"
] @keyword.operator

[
  "|>"
  "=="
  "!="
  "<"
  "<="
  ">"
  ">="
  "+"
  "-"
  "*"
  "/"
  "="
  "->"
] @operator
[
  "("
  ")"
  "["
  "]"
  "{"
  "}"
] @punctuation.bracket
[
  ","
  ":"
  "."
] @punctuation.delimiter
