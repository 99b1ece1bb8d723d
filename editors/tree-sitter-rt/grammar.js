/**
 * The grammar of `.rt` files for editors.
 *
 * It takes exactly what `grammar/rt.pest` takes without a slip; `tests/agreement.rs` holds the two together. What pest
 * has in `cut.rs`, which line ends separate, is in `src/scanner.c` here.
 *
 * @license MIT OR Apache-2.0
 */

/// <reference types="tree-sitter-cli/dsl" />
// @ts-check

/** How tightly operators bind, the loosest first. */
const BINDS = { pipe: 1, or: 2, and: 3, not: 4, compare: 5, to: 6, sum: 7, product: 8, negate: 9 };

/** The signs and words behind which a statement goes on, on the next line too. */
const OPEN = {
  colon: ':',
  equals: '=',
  comma: ',',
  point: '.',
  arrow: '->',
  parenthesis: '(',
  bracket: '[',
  in: 'in',
  then: 'then',
  else: 'else',
  pipe: '|>',
  or: 'or',
  and: 'and',
  not: 'not',
  compare: choice('==', '!=', '<', '<=', '>', '>='),
  to: 'to',
  sum: choice('+', '-'),
  product: choice('*', '/'),
  negate: '-',
};

/** The operators between two operands, save `|>`. */
const BETWEEN = ['or', 'and', 'compare', 'to', 'sum', 'product'];

/** The words of the language, which cannot be names. */
const RESERVED = [
  'let', 'material', 'and', 'or', 'not', 'true', 'false', 'param', 'part', 'import', 'as', 'for', 'in', 'if', 'then',
  'else', 'fn', 'to', 'assert',
];

/** Those of them that name a field all the same. An argument may be called anything but `for`. */
const NAMES_OF_FIELDS = ['material', 'to', 'in', 'as', 'part'];
const NAMES_OF_ARGUMENTS = RESERVED.filter(word => word !== 'for');

const named = ($, words) => choice($.identifier, ...words.map(word => alias(word, $.identifier)));

/** `a, b, c` within parentheses, where line ends mean nothing; a comma may stand behind the last. */
const listed = ($, rule) => seq(rule, repeat(seq($._comma, rule)), optional($._comma));

/** An operator between two operands. */
const joined = ($, operator, left, right) =>
  prec.left(BINDS[operator], seq(field('left', left), field('operator', $[`_${operator}`]), field('right', right)));

const binary = ($, operand) => choice(...BETWEEN.map(operator => joined($, operator, operand, operand)));

const unary = ($, operand) =>
  choice(...['not', 'negate'].map(operator =>
    prec(BINDS[operator], seq(field('operator', $[`_${operator}`]), field('operand', operand)))));

const index = ($, value) => seq(field('value', value), $._bracket, field('index', $._expression), ']');

const member = ($, value) => seq(field('value', value), $._point, field('member', $._any_name));

module.exports = grammar({
  name: 'rt',

  // The order is that of `src/scanner.c`.
  externals: $ => [
    // Line ends that separate, and those that do not.
    $._newline,
    $._joined,
    // Never found: it tells the scanner that the line goes on.
    $._open,
    $.number,
    $.unit,
    // The comma before the message of an `assert`.
    $._before_message,
    // Found by the lexer: they tell the scanner what surrounds it.
    ')',
    ']',
    '@',
  ],

  extras: $ => [/[ \t\r\f]/, $._joined, $.comment, $.doc_comment],

  word: $ => $.identifier,

  reserved: {
    global: _ => RESERVED,
    nothing: _ => [],
  },

  supertypes: $ => [$._expression],

  inline: $ => [$._name_of_field, $._name_of_argument, $._any_name, $._tight, $._head],

  rules: {
    source_file: $ => seq(optional($._marks_of_encoding), repeat($._newline), optional($._entries)),

    // Marks of the encoding that programs left; the first is skipped by every lexer.
    _marks_of_encoding: _ => /\uFEFF[\uFEFF\s]*/,

    // --- Bodies ----------------------------------------------------------------------------------------------

    body: $ => seq('{', repeat($._newline), optional($._entries), '}'),

    _entries: $ => seq($._entry, repeat(seq($._separator, $._entry)), optional($._separator)),

    _separator: $ => choice(
      seq(',', repeat($._newline)),
      seq(repeat1($._newline), optional(seq(',', repeat($._newline)))),
    ),

    _entry: $ => choice($.field, seq(repeat($.mark), $._statement)),

    field: $ => seq(field('name', $._name_of_field), $._colon, field('value', $._expression)),

    mark: $ => seq('@', field('name', $._any_name), optional(field('arguments', $.arguments))),

    _statement: $ => choice(
      $.thing, $.definition, $.param, $.part, $.import, $.function, $.for_statement, $.if_statement, $.assertion,
    ),

    thing: $ => seq(
      field('kind', choice($.identifier, $.path)),
      optional(field('name', $.identifier)),
      field('body', $.body),
    ),

    definition: $ => seq(
      field('keyword', choice('let', 'material')),
      field('name', $.identifier),
      $._equals,
      field('value', $._expression),
    ),

    // --- Statements with a word of their own -------------------------------------------------------------------

    param: $ => seq(
      'param',
      field('name', $.identifier),
      $._colon,
      field('type', $._type),
      $._equals,
      field('default', $._expression),
      optional(seq($._in, field('range', $._expression))),
    ),

    part: $ => seq('part', field('name', $.identifier), field('body', $.body)),

    import: $ => seq('import', field('path', $.text), 'as', field('name', $.identifier)),

    function: $ => seq(
      'fn',
      field('name', $.identifier),
      field('parameters', $.parameters),
      $._arrow,
      field('type', $._type),
      $._equals,
      field('value', $._expression),
    ),

    parameters: $ => seq($._parenthesis, optional(listed($, $.parameter)), ')'),

    parameter: $ => seq(field('name', $.identifier), optional($._open), $._colon, field('type', $._type)),

    for_statement: $ => seq(
      'for',
      field('variable', $.identifier),
      $._in,
      field('list', $._head),
      field('body', $.body),
    ),

    if_statement: $ => seq(
      'if',
      field('condition', $._head),
      field('then', $.body),
      optional(seq($._else, field('else', choice($.body, $.if_statement)))),
    ),

    assertion: $ => seq(
      'assert',
      field('condition', $._expression),
      optional(seq(alias($._before_message, ','), optional($._open), field('message', $._expression))),
    ),

    _type: $ => choice($.type, $.list_type),
    type: $ => choice($.identifier, 'material'),
    list_type: $ => seq($._bracket, $._type, ']'),

    // --- Expressions -------------------------------------------------------------------------------------------

    _expression: $ => choice(alias($._piped, $.binary), $.conditional, $._tight),

    _piped: $ => joined($, 'pipe', $._expression, choice($.conditional, $._tight)),

    // What stands behind `else` ends before `|>`.
    conditional: $ => seq(
      'if',
      field('condition', $._head),
      $._then,
      field('then', $._expression),
      $._else,
      field('else', choice($.conditional, $._tight)),
    ),

    _tight: $ => choice($.binary, $.unary, $._operand),
    binary: $ => binary($, $._tight),
    unary: $ => unary($, $._tight),

    _operand: $ => choice($.identifier, $.path, $._value),

    // Whatever is no name: behind a name, a point goes on with the path.
    _value: $ => choice($._simple, $.construct, $.member, $.index),
    construct: $ => seq(field('kind', choice($.identifier, $.path)), field('body', $.body)),
    member: $ => member($, $._value),
    index: $ => index($, $._operand),

    // In the head of `for` and `if`, `{` opens the body: no `construct` stands there but within parentheses.
    _head: $ => choice(alias($._head_piped, $.binary), $._head_tight),
    _head_piped: $ => joined($, 'pipe', $._head, $._head_tight),
    _head_tight: $ => choice(alias($._head_binary, $.binary), alias($._head_unary, $.unary), $._head_operand),
    _head_binary: $ => binary($, $._head_tight),
    _head_unary: $ => unary($, $._head_tight),
    _head_operand: $ => choice($.identifier, $.path, $._head_value),
    _head_value: $ => choice($._simple, alias($._head_member, $.member), alias($._head_index, $.index)),
    _head_member: $ => member($, $._head_value),
    _head_index: $ => index($, $._head_operand),

    _simple: $ => choice(
      $.number, $.quantity, $.color, $.text, $.boolean, $.list, $.parenthesized, $.tuple, $.call, $.scaled,
    ),

    path: $ => seq($.identifier, repeat1(seq($._point, field('member', $._any_name)))),

    call: $ => seq(field('function', choice($.identifier, $.path)), field('arguments', $.arguments)),

    arguments: $ => seq($._parenthesis, optional(listed($, $.argument)), ')'),

    argument: $ => seq(
      optional(seq(field('name', $._name_of_argument), $._colon)),
      field('value', $._expression),
    ),

    scaled: $ => seq(field('value', choice($.parenthesized, $.tuple, $.call)), field('unit', $.unit)),

    parenthesized: $ => seq($._parenthesis, $._expression, optional($._comma), ')'),

    tuple: $ => seq(
      $._parenthesis,
      $._expression,
      repeat1(seq($._comma, $._expression)),
      optional($._comma),
      ')',
    ),

    list: $ => seq($._bracket, optional(listed($, $._expression)), ']'),

    // --- Names and literals ------------------------------------------------------------------------------------

    _name_of_field: $ => named($, NAMES_OF_FIELDS),
    _name_of_argument: $ => named($, NAMES_OF_ARGUMENTS),

    _any_name: $ => reserved('nothing', $.identifier),

    identifier: _ => /[\p{XID_Start}_]\p{XID_Continue}*/,

    quantity: $ => seq(field('value', $.number), field('unit', $.unit)),

    color: _ => /#([0-9a-fA-F]{3}|[0-9a-fA-F]{6})/,

    boolean: _ => choice('true', 'false'),

    text: $ => seq('"', repeat(choice($._text, $.escape)), token.immediate('"')),
    _text: _ => token.immediate(prec(1, /[^"\\\n]+/)),
    escape: _ => token.immediate(/\\["\\nt]/),

    // `///` documents what follows; `////` is a line of slashes.
    comment: _ => token(choice(
      seq('//', /([^\/\r\n][^\r\n]*)?/),
      seq('////', /[^\r\n]*/),
      /\/\*[^*]*\*+([^\/*][^*]*\*+)*\//,
    )),

    doc_comment: _ => token(seq('///', /([^\/\r\n][^\r\n]*)?/)),

    // --- Where a line goes on ----------------------------------------------------------------------------------

    ...Object.fromEntries(Object.entries(OPEN).map(([name, sign]) => [`_${name}`, $ => seq(sign, optional($._open))])),
  },
});
