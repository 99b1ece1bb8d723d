[
  (body)
  (list)
  (list_type)
  (arguments)
  (parameters)
  (parenthesized)
  (tuple)
] @indent.begin

[
  "}"
  "]"
  ")"
] @indent.branch @indent.end

[
  (comment)
  (doc_comment)
] @indent.auto
