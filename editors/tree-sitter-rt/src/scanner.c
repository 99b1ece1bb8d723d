// What depends on the neighbourhood: line ends, numbers and the units that touch them.
//
// The same as `src/syntax/cut/lines.rs`: a line end separates, save within parentheses and brackets, behind an
// operator, `=`, `:` or a mark such as `@off`, and before a line that starts with `->`, a binary operator other than
// `-`, a word that goes on with a statement such as `else`, `.member` or `{`. Which tokens the parser could take tells
// what stands before the line end. Where a value is wanted behind it, no thing begins the next line that is not indented
// deeper: what stands before is unfinished.

#include "tree_sitter/alloc.h"
#include "tree_sitter/parser.h"

// In the order of `externals` in grammar.js.
enum Token { NEWLINE, JOINED, OPEN, NUMBER, UNIT, BEFORE_MESSAGE, CLOSES_PARENTHESIS, CLOSES_BRACKET, MARK };

// The words in the middle of a statement.
static const char *const GOES_ON[] = {"and", "or", "to", "in", "as", "then", "else", "elif", "elseif", "elsif"};

// The units that may stand behind `/`, which divides otherwise. tests/agreement.rs knows if one is missing.
static const char *const UNITS[] = {"nm", "um", "mm",  "cm",  "m",    "km", "in", "ft",
                                    "deg", "rad", "turn", "mW", "W", "kW", "K"};

// What is kept from one token to the next.
typedef struct {
  // Where the line begins behind a line end that does not separate: nothing there touches what stands before.
  uint32_t begins;
  // The column at which this line begins.
  uint32_t indent;
} State;

// No line begins there.
static const uint32_t NOWHERE = UINT32_MAX;

#define LENGTH(list) (sizeof(list) / sizeof((list)[0]))

// Longer than any word in the lists above.
#define LONGEST 8

static bool is_digit(int32_t c) { return c >= '0' && c <= '9'; }

// Letters beyond ASCII roughly: no unit has one, so all that depends on it is where an unknown unit ends.
static bool is_letter(int32_t c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == 0xAA || c == 0xB5 || c == 0xBA ||
         (c >= 0xC0 && c < 0x2000 && c != 0xD7 && c != 0xF7) || (c >= 0x3040 && c < 0xD800);
}

static bool is_word(int32_t c) { return is_letter(c) || is_digit(c) || c == '_'; }

static bool is_blank(int32_t c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f'; }

static void advance(TSLexer *lexer) { lexer->advance(lexer, false); }

static void skip(TSLexer *lexer) { lexer->advance(lexer, true); }

static bool equal(const char *a, const char *b) {
  while (*a && *a == *b) a++, b++;
  return *a == *b;
}

static bool among(const char *word, const char *const *list, size_t count) {
  for (size_t i = 0; i < count; i++) {
    if (equal(word, list[i])) return true;
  }
  return false;
}

// Reads a word of ASCII. Gives it empty if it is longer than all that are asked for.
static void read_word(TSLexer *lexer, char word[LONGEST]) {
  size_t length = 0;
  while (is_word(lexer->lookahead)) {
    if (length < LONGEST) word[length] = lexer->lookahead < 128 ? (char)lexer->lookahead : '?';
    length++;
    advance(lexer);
  }
  word[length < LONGEST ? length : 0] = 0;
}

// --- Literals -------------------------------------------------------------------------------------------------

// Reads the name of a unit with an exponent of one digit, or none.
static bool read_unit_name(TSLexer *lexer) {
  char word[LONGEST];
  read_word(lexer, word);
  size_t length = 0;
  while (word[length]) length++;
  if (length > 1 && is_digit(word[length - 1])) word[length - 1] = 0;
  return among(word, UNITS, LENGTH(UNITS));
}

// Reads `%` or a word, and units behind `/`. What is no unit there is left; `mark` says to mark the end.
static bool read_unit(TSLexer *lexer, bool mark) {
  if (lexer->lookahead == '%') {
    advance(lexer);
  } else if (is_letter(lexer->lookahead)) {
    bool exponent = lexer->lookahead == 'e' || lexer->lookahead == 'E';
    advance(lexer);
    if (exponent && !is_word(lexer->lookahead)) return false;
    while (is_word(lexer->lookahead)) advance(lexer);
  } else {
    return false;
  }
  if (mark) lexer->mark_end(lexer);
  while (lexer->lookahead == '/') {
    advance(lexer);
    if (!read_unit_name(lexer)) return true;
    if (mark) lexer->mark_end(lexer);
  }
  return true;
}

// How large a number is, as far as that matters.
typedef struct {
  // The whole number, or some that is larger than any that is exact.
  uint64_t value;
  // How many digits stand before the point, without zeros before them.
  uint32_t digits;
} Size;

// From here on not every whole number is one that is computed with: 2^53.
static const uint64_t INEXACT = UINT64_C(9007199254740992);

// More digits than the largest number that is finite has.
static const uint32_t HUGE_DIGITS = 309;

// Reads digits in groups: `1_000`. False where a `_` stands without digits behind it.
static bool read_digits(TSLexer *lexer, Size *size) {
  for (;;) {
    if (!is_digit(lexer->lookahead)) return false;
    for (; is_digit(lexer->lookahead); advance(lexer)) {
      if (size->value < INEXACT) size->value = size->value * 10 + (uint64_t)(lexer->lookahead - '0');
      if (size->value > 0) size->digits++;
    }
    lexer->mark_end(lexer);
    if (lexer->lookahead != '_') return true;
    advance(lexer);
  }
}

// Behind a 0, `x10` and the like is no unit but a number as other languages write it.
static bool is_other_base(TSLexer *lexer) {
  int32_t base = lexer->lookahead | 0x20;
  if (base != 'x' && base != 'b' && base != 'o') return false;
  advance(lexer);
  for (; is_word(lexer->lookahead); advance(lexer)) {
    int32_t letter = lexer->lookahead | 0x20;
    if (!is_digit(lexer->lookahead) && !(base == 'x' && letter >= 'a' && letter <= 'f')) return false;
  }
  return true;
}

// Reads a number, and looks at what touches it: a number with anything but a unit behind it is none.
static bool read_number(TSLexer *lexer) {
  bool zero = lexer->lookahead == '0';
  Size size = {0, 0};
  if (!read_digits(lexer, &size)) return false;
  zero = zero && size.value == 0;
  bool whole = true;
  if (lexer->lookahead == '.') {
    advance(lexer);
    // `1..2` is a slip of the whole, not of the number.
    if (lexer->lookahead == '.') return true;
    Size fraction = {0, 0};
    if (!read_digits(lexer, &fraction)) return false;
    zero = whole = false;
  }
  if (lexer->lookahead == 'e' || lexer->lookahead == 'E') {
    advance(lexer);
    bool negative = lexer->lookahead == '-';
    bool sign = negative || lexer->lookahead == '+';
    if (sign) advance(lexer);
    if (is_digit(lexer->lookahead)) {
      uint32_t exponent = 0;
      for (; is_digit(lexer->lookahead); advance(lexer)) {
        if (exponent < HUGE_DIGITS) exponent = exponent * 10 + (uint32_t)(lexer->lookahead - '0');
      }
      lexer->mark_end(lexer);
      if (!negative && size.value > 0) size.digits += exponent;
      zero = whole = false;
    } else if (sign || !is_word(lexer->lookahead)) {
      return false;
    }
  }
  if (zero && is_other_base(lexer)) return false;
  bool plain = !is_word(lexer->lookahead) && lexer->lookahead != '%';
  if (size.digits > HUGE_DIGITS || (plain && whole && size.value >= INEXACT)) return false;
  if (is_word(lexer->lookahead)) {
    if (lexer->lookahead == '_') return false;
    while (is_word(lexer->lookahead)) advance(lexer);
  } else if (lexer->lookahead == '%') {
    advance(lexer);
    if (is_word(lexer->lookahead)) return false;
  }
  if (lexer->lookahead != '.') return true;
  advance(lexer);
  return lexer->lookahead == '.';
}

// --- Line ends ------------------------------------------------------------------------------------------------

static void skip_line(TSLexer *lexer) {
  while (!lexer->eof(lexer) && lexer->lookahead != '\n') advance(lexer);
}

// Skips the rest of a block comment; says whether a line ends in it.
static bool skip_block(TSLexer *lexer) {
  bool lines = false;
  advance(lexer);
  while (!lexer->eof(lexer)) {
    int32_t c = lexer->lookahead;
    lines |= c == '\n';
    advance(lexer);
    if (c == '*' && lexer->lookahead == '/') {
      advance(lexer);
      break;
    }
  }
  return lines;
}

// What the next token says of a line end.
typedef enum { SEPARATES, GOES_ON_BEHIND, BEGINS_THING } Next;

static void skip_blanks(TSLexer *lexer) {
  while (is_blank(lexer->lookahead)) advance(lexer);
}

static void skip_word(TSLexer *lexer) {
  while (is_word(lexer->lookahead)) advance(lexer);
  skip_blanks(lexer);
}

// Whether `{` comes behind the first word of a line, or behind the path that begins there and a name.
static bool begins_thing(TSLexer *lexer) {
  skip_blanks(lexer);
  while (lexer->lookahead == '.') {
    advance(lexer);
    skip_word(lexer);
  }
  if (is_letter(lexer->lookahead)) skip_word(lexer);
  return lexer->lookahead == '{';
}

// Looks at the next token, behind white space and comments; `column` is where it begins.
static Next next_token(TSLexer *lexer, uint32_t *column) {
  for (;;) {
    while (is_blank(lexer->lookahead) || lexer->lookahead == '\n') advance(lexer);
    int32_t c = lexer->lookahead;
    *column = lexer->get_column(lexer);
    if (is_letter(c)) {
      char word[LONGEST];
      read_word(lexer, word);
      bool named = lexer->lookahead == ':' || lexer->lookahead == '=';
      if (among(word, GOES_ON, LENGTH(GOES_ON)) && (equal(word, "else") || !named)) return GOES_ON_BEHIND;
      return !equal(word, "if") && begins_thing(lexer) ? BEGINS_THING : SEPARATES;
    }
    if (!lexer->eof(lexer)) advance(lexer);
    int32_t next = lexer->lookahead;
    switch (c) {
      case '/':
        if (next == '/') {
          skip_line(lexer);
        } else if (next == '*') {
          skip_block(lexer);
        } else {
          return GOES_ON_BEHIND;
        }
        continue;
      case '+': case '*': case '<': case '>': case '{':
        return GOES_ON_BEHIND;
      case '|': case '-':
        return next == '>' ? GOES_ON_BEHIND : SEPARATES;
      case '=': case '!':
        return next == '=' ? GOES_ON_BEHIND : SEPARATES;
      case '.':
        return is_letter(next) || next == '_' ? GOES_ON_BEHIND : SEPARATES;
      default:
        return SEPARATES;
    }
  }
}

// Whether the line goes on with the next token.
static bool goes_on(TSLexer *lexer) {
  uint32_t column;
  return next_token(lexer, &column) == GOES_ON_BEHIND;
}

static bool line_end(State *state, TSLexer *lexer, const bool *valid, bool recovers) {
  while (is_blank(lexer->lookahead) || lexer->lookahead == '\n') advance(lexer);
  lexer->mark_end(lexer);
  state->begins = lexer->get_column(lexer);
  uint32_t before = state->indent;
  // A comment alone on its line does not say how far the line is indented.
  if (lexer->lookahead != '/') state->indent = state->begins;
  bool inside = !recovers && (valid[CLOSES_PARENTHESIS] || valid[CLOSES_BRACKET]);
  uint32_t column = 0;
  Next next = inside ? GOES_ON_BEHIND : next_token(lexer, &column);
  bool joined = next == GOES_ON_BEHIND;
  if (valid[NEWLINE] && !joined) {
    lexer->result_symbol = NEWLINE;
    return true;
  }
  bool unfinished = next == BEGINS_THING && column <= before && !valid[MARK];
  lexer->result_symbol = JOINED;
  return valid[JOINED] && (joined || (valid[OPEN] && !unfinished) || valid[MARK]);
}

// A comma with a text or a parenthesis behind it, which begin no entry.
static bool before_message(TSLexer *lexer) {
  advance(lexer);
  lexer->mark_end(lexer);
  for (;;) {
    while (is_blank(lexer->lookahead) || lexer->lookahead == '\n') advance(lexer);
    if (lexer->lookahead != '/') return lexer->lookahead == '"' || lexer->lookahead == '(';
    advance(lexer);
    if (lexer->lookahead == '/') {
      skip_line(lexer);
    } else if (lexer->lookahead == '*') {
      skip_block(lexer);
    } else {
      return false;
    }
  }
}

// --- The interface to tree-sitter -----------------------------------------------------------------------------

bool tree_sitter_rt_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
  State *state = payload;
  // Where a line may end, none is open: both are valid only while the parser recovers from an error.
  bool recovers = valid[NEWLINE] && valid[OPEN];
  if (valid[UNIT] && !recovers && (is_letter(lexer->lookahead) || lexer->lookahead == '%')) {
    bool touches = state->begins != lexer->get_column(lexer);
    lexer->result_symbol = UNIT;
    state->begins = NOWHERE;
    return touches && read_unit(lexer, true);
  }
  bool blank = is_blank(lexer->lookahead);
  while (is_blank(lexer->lookahead)) skip(lexer);
  if (lexer->lookahead == '\n') return line_end(state, lexer, valid, recovers);
  state->begins = NOWHERE;
  if (lexer->lookahead == '/' && blank && valid[NEWLINE]) {
    // A comment in which the line ends. The token stands before it, and is empty.
    lexer->mark_end(lexer);
    advance(lexer);
    if (lexer->lookahead != '*') return false;
    lexer->result_symbol = NEWLINE;
    return skip_block(lexer) && !goes_on(lexer);
  }
  if (valid[NUMBER] && is_digit(lexer->lookahead)) {
    lexer->result_symbol = NUMBER;
    return read_number(lexer);
  }
  if (valid[BEFORE_MESSAGE] && !recovers && lexer->lookahead == ',') {
    lexer->result_symbol = BEFORE_MESSAGE;
    return before_message(lexer);
  }
  return false;
}

void *tree_sitter_rt_external_scanner_create(void) {
  State *state = ts_malloc(sizeof(State));
  if (state) *state = (State){NOWHERE, 0};
  return state;
}

void tree_sitter_rt_external_scanner_destroy(void *payload) { ts_free(payload); }

unsigned tree_sitter_rt_external_scanner_serialize(void *payload, char *buffer) {
  const State *state = payload;
  const uint32_t kept[] = {state->begins, state->indent};
  for (unsigned i = 0; i < sizeof(kept); i++) buffer[i] = (char)(kept[i / 4] >> 8 * (i % 4));
  return sizeof(kept);
}

void tree_sitter_rt_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
  State *state = payload;
  uint32_t kept[] = {0, 0};
  bool known = length >= sizeof(kept);
  for (unsigned i = 0; known && i < sizeof(kept); i++) kept[i / 4] |= (uint32_t)(unsigned char)buffer[i] << 8 * (i % 4);
  *state = known ? (State){kept[0], kept[1]} : (State){NOWHERE, 0};
}
