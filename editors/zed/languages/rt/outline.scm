(thing
  kind: (_) @context
  name: (identifier) @name) @item
(definition
  keyword: _ @context
  name: (identifier) @name) @item
(param
  "param" @context
  name: (identifier) @name) @item
(part
  "part" @context
  name: (identifier) @name) @item
(function
  "fn" @context
  name: (identifier) @name) @item
(import
  "import" @context
  name: (identifier) @name) @item
