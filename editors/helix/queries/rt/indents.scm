[
  (body)
  (list)
  (list_type)
  (arguments)
  (parameters)
  (parenthesized)
  (tuple)
] @indent

[
  "}"
  "]"
  ")"
] @outdent
