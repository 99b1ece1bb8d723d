[
  (body)
  (list)
  (arguments)
  (parameters)
  (comment)
] @fold
