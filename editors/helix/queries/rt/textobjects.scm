; A function.
(function
  value: (_) @function.inside) @function.around

; A thing, or what makes one.
(thing
  body: (body) @class.inside) @class.around
(construct
  body: (body) @class.inside) @class.around
(part
  body: (body) @class.inside) @class.around

(for_statement
  body: (body) @loop.inside) @loop.around
(if_statement
  then: (body) @conditional.inside) @conditional.around
(conditional
  then: (_) @conditional.inside) @conditional.around

; `name: value`
(field
  value: (_) @entry.inside) @entry.around
(field
  name: (_) @entry.inside)
(definition
  value: (_) @entry.inside) @entry.around
(definition
  name: (_) @entry.inside)

(argument
  value: (_) @parameter.inside) @parameter.around
(parameter) @parameter.inside @parameter.around

(call
  arguments: (arguments) @call.inside) @call.around

[
  (comment)
  (doc_comment)
] @comment.around
