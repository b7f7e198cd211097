// Numbers, units behind numbers and comments that nest: what the rules of grammar.js cannot look far enough ahead for.
// It keeps nothing between tokens.

#include "tree_sitter/parser.h"
#include <string.h>

enum Token { NUMBER, UNIT, BLOCK_COMMENT, BLOCK_DOC_COMMENT };

void *tree_sitter_mbs_external_scanner_create(void) { return NULL; }
void tree_sitter_mbs_external_scanner_destroy(void *payload) { (void)payload; }
unsigned tree_sitter_mbs_external_scanner_serialize(void *payload, char *buffer) {
  (void)payload;
  (void)buffer;
  return 0;
}
void tree_sitter_mbs_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
  (void)payload;
  (void)buffer;
  (void)length;
}

// The units of one quantity together, as in mbs-derive/src/parse/in_place.rs.
static const char *const UNITS[][6] = {
    {"kg", "g", "t"}, {"m", "km", "dm", "cm", "mm", "um"}, {"s", "ms", "us", "min", "h"}, {"rad", "deg"},
    {"N", "mN", "kN", "MN"}, {"J", "kJ", "MJ"}, {"W", "kW", "MW"}, {"Pa", "kPa", "MPa", "GPa", "bar"},
    {"Hz", "kHz", "rpm"}, {"A", "mA"}, {"V"}, {"C"}, {"T"}, {"Wb"}, {"H"}, {"F"}, {"ohm"}, {"K"}, {"mol"}, {"cd"},
};
enum { QUANTITIES = sizeof UNITS / sizeof UNITS[0], NONE = -1, LONGEST = 8 };

static int quantity_of(const char *word) {
  for (int i = 0; i < QUANTITIES; i++)
    for (int j = 0; j < 6 && UNITS[i][j]; j++)
      if (strcmp(word, UNITS[i][j]) == 0) return i;
  return NONE;
}

static bool is_digit(int32_t c) { return c >= '0' && c <= '9'; }
static bool begins_word(int32_t c) { return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); }
static bool is_space(int32_t c) { return c == ' ' || c == '\t' || c == '\r' || c == 0xa0 || c == 0x200e || c == 0x200f; }
static void advance(TSLexer *lexer) { lexer->advance(lexer, false); }

static void digits(TSLexer *lexer) {
  while (is_digit(lexer->lookahead) || lexer->lookahead == '_') advance(lexer);
}

// `1`, `1.`, `1.5e-3`; of `0..n` and `1.sin()` the digits alone.
static bool number(TSLexer *lexer) {
  lexer->result_symbol = NUMBER;
  digits(lexer);
  lexer->mark_end(lexer);
  if (lexer->lookahead == '.') {
    advance(lexer);
    if (lexer->lookahead == '.' || begins_word(lexer->lookahead)) return true;
    digits(lexer);
    lexer->mark_end(lexer);
  }
  if (lexer->lookahead == 'e' || lexer->lookahead == 'E') {
    advance(lexer);
    if (lexer->lookahead == '+' || lexer->lookahead == '-') advance(lexer);
    if (!is_digit(lexer->lookahead)) return true;
    digits(lexer);
    lexer->mark_end(lexer);
  }
  return true;
}

// A word, if it is short enough for a unit; it is gone through in any case.
static void word(TSLexer *lexer, char *text) {
  int length = 0;
  while (begins_word(lexer->lookahead) || is_digit(lexer->lookahead)) {
    if (length < LONGEST) text[length++] = (char)lexer->lookahead;
    advance(lexer);
  }
  text[length < LONGEST ? length : 0] = '\0';
}

// Behind a unit: whether it is a name after all, which is called, indexed or has a component. White space and line
// breaks may stand in between.
static bool is_applied(TSLexer *lexer) {
  while (is_space(lexer->lookahead) || lexer->lookahead == '\n') advance(lexer);
  if (lexer->lookahead == '(' || lexer->lookahead == '[') return true;
  if (lexer->lookahead != '.') return false;
  advance(lexer);
  return begins_word(lexer->lookahead);
}

// `^2`, `^-1`, `^(1/2)` written against the unit.
static void exponent(TSLexer *lexer) {
  if (lexer->lookahead != '^') return;
  advance(lexer);
  if (lexer->lookahead == '(') {
    while (lexer->lookahead != ')' && lexer->lookahead != '\n' && !lexer->eof(lexer)) advance(lexer);
    if (lexer->lookahead == ')') advance(lexer);
  } else {
    if (lexer->lookahead == '-') advance(lexer);
    digits(lexer);
  }
  lexer->mark_end(lexer);
}

// `kg*m^2/s^2` behind a number: the longest unit, which ends before `t` and before a second unit of the same quantity,
// unless one divides by the same unit again.
static bool unit(TSLexer *lexer) {
  char text[LONGEST + 1], divisors[QUANTITIES][LONGEST + 1];
  bool seen[QUANTITIES] = {false};
  memset(divisors, 0, sizeof divisors);
  lexer->result_symbol = UNIT;
  word(lexer, text);
  int quantity = quantity_of(text);
  if (quantity == NONE) return false;
  lexer->mark_end(lexer);
  if (lexer->lookahead != '^' && lexer->lookahead != '*' && lexer->lookahead != '/') return !is_applied(lexer);
  seen[quantity] = true;
  exponent(lexer);
  while (lexer->lookahead == '*' || lexer->lookahead == '/') {
    bool divides = lexer->lookahead == '/';
    advance(lexer);
    if (!begins_word(lexer->lookahead)) return true;
    word(lexer, text);
    quantity = quantity_of(text);
    if (quantity == NONE || strcmp(text, "t") == 0) return true;
    if (seen[quantity] && !(divides && strcmp(divisors[quantity], text) == 0)) return true;
    // A name that is called, indexed or has a component. A blank before the bracket is not looked behind: the end of
    // the token can be marked nowhere but here.
    int32_t next = lexer->lookahead;
    if (next == '(' || next == '[' || next == '.') return true;
    lexer->mark_end(lexer);
    exponent(lexer);
    seen[quantity] = true;
    if (divides) strcpy(divisors[quantity], text);
  }
  return true;
}

// Behind `/*`.
static bool block_comment(TSLexer *lexer, const bool *valid) {
  advance(lexer);
  int32_t first = lexer->lookahead;
  bool documents = first == '!' || first == '*';
  if (first == '*') {
    advance(lexer);
    // `/**/` and `/***` are no documentation.
    if (lexer->lookahead == '/') {
      advance(lexer);
      lexer->result_symbol = BLOCK_COMMENT;
      return valid[BLOCK_COMMENT];
    }
    if (lexer->lookahead == '*') documents = false;
  }
  int depth = 1;
  while (depth > 0) {
    if (lexer->eof(lexer)) return false;
    int32_t c = lexer->lookahead;
    advance(lexer);
    if (c == '*' && lexer->lookahead == '/') {
      depth--;
      advance(lexer);
    } else if (c == '/' && lexer->lookahead == '*') {
      depth++;
      advance(lexer);
    }
  }
  lexer->result_symbol = documents ? BLOCK_DOC_COMMENT : BLOCK_COMMENT;
  return valid[lexer->result_symbol];
}

bool tree_sitter_mbs_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
  (void)payload;
  bool breaks = false;
  while (is_space(lexer->lookahead) || lexer->lookahead == '\n' || lexer->lookahead == 0xfeff) {
    breaks = breaks || lexer->lookahead == '\n';
    lexer->advance(lexer, true);
  }
  if (lexer->lookahead == '/') {
    lexer->mark_end(lexer);
    advance(lexer);
    if (lexer->lookahead != '*' || !(valid[BLOCK_COMMENT] || valid[BLOCK_DOC_COMMENT])) return false;
    if (!block_comment(lexer, valid)) return false;
    lexer->mark_end(lexer);
    return true;
  }
  if (valid[NUMBER] && is_digit(lexer->lookahead)) return number(lexer);
  if (valid[UNIT] && !breaks && begins_word(lexer->lookahead)) return unit(lexer);
  return false;
}
