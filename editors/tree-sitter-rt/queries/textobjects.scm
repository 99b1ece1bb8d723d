; A function.
(function
  value: (_) @function.inner) @function.outer

; A thing, or what makes one.
(thing
  body: (body) @class.inner) @class.outer
(construct
  body: (body) @class.inner) @class.outer
(part
  body: (body) @class.inner) @class.outer

(for_statement
  body: (body) @loop.inner) @loop.outer
(if_statement
  then: (body) @conditional.inner) @conditional.outer
(conditional
  then: (_) @conditional.inner) @conditional.outer

; `name: value`
(field
  value: (_) @assignment.rhs) @assignment.outer
(field
  name: (_) @assignment.lhs)
(definition
  value: (_) @assignment.rhs) @assignment.outer
(definition
  name: (_) @assignment.lhs)

(argument
  value: (_) @parameter.inner) @parameter.outer
(parameter) @parameter.inner @parameter.outer

(call
  arguments: (arguments) @call.inner) @call.outer

[
  (comment)
  (doc_comment)
] @comment.outer
