[
  (source_file)
  (body)
  (function)
  (for_statement)
] @local.scope

(definition
  name: (identifier) @local.definition)
(param
  name: (identifier) @local.definition)
(part
  name: (identifier) @local.definition)
(import
  name: (identifier) @local.definition)
(function
  name: (identifier) @local.definition)
(parameter
  name: (identifier) @local.definition)
(thing
  name: (identifier) @local.definition)
(for_statement
  variable: (identifier) @local.definition)

(identifier) @local.reference
