/// <reference types="tree-sitter-cli/dsl" />
// The grammar of docs/language.md, section 3. Numbers, units behind numbers and comments that nest are read by
// src/scanner.c: where a unit ends depends on what stands behind it.

const PREC = { or: 1, and: 2, compare: 3, sum: 4, product: 5, sign: 6, power: 7, postfix: 8 };

const listed = (rule) => optional(seq(rule, repeat(seq(',', rule)), optional(',')));

module.exports = grammar({
  name: 'mbs',

  externals: ($) => [$.number, $.unit, $.block_comment, $.block_doc_comment],
  extras: ($) => [/\s/, /[\u200e\u200f\ufeff]/, $.doc_comment, $.comment, $.block_comment, $.block_doc_comment],
  word: ($) => $.identifier,
  supertypes: ($) => [$._statement, $._expression],

  conflicts: ($) => [
    // `gravity [0, 0, -g];` is a field, `gravity[0] = 1;` gives an element its value.
    [$.gravity_statement, $._assignable],
    [$.shape_statement, $._assignable],
  ],

  rules: {
    source_file: ($) =>
      seq(
        repeat(choice($.attribute, $.import)),
        choice($.mechanism, repeat(choice($.const_statement, $.function_statement, $.part_statement))),
      ),

    // The order counts: `/// x` is documentation, `//// x` is longer as a comment.
    doc_comment: (_) => token(choice(/\/\/\/([^/\n][^\n]*)?/, /\/\/![^\n]*/)),
    comment: (_) => token(/\/\/[^\n]*/),

    attribute: ($) => seq('#', '!', '[', field('name', $.identifier), ']'),
    import: ($) => seq('import', field('path', $.path), ';'),
    path: (_) => /"[^"\n]*"/,

    mechanism: ($) => seq('mechanism', field('name', $.identifier), field('body', $.block)),
    block: ($) => seq('{', repeat($._statement), '}'),

    _statement: ($) =>
      choice(
        $.param_statement,
        $.coord_statement,
        $.input_statement,
        $.prescribed_statement,
        $.const_statement,
        $.function_statement,
        $.let_statement,
        $.assignment,
        $.energy_statement,
        $.force_statement,
        $.force_at_statement,
        $.torque_statement,
        $.gravity_statement,
        $.reaction_statement,
        $.shape_statement,
        $.constraint_statement,
        $.output_statement,
        $.part_statement,
        $.instance,
        $.for_statement,
        $.if_statement,
      ),

    // ---- declarations

    param_statement: ($) =>
      seq(
        'param',
        field('name', $.identifier),
        optional(seq($._index, optional($._index))),
        ':',
        field('unit', $.declared_unit),
        optional($._value),
        optional(seq(',', 'positive')),
        ';',
      ),
    coord_statement: ($) =>
      seq('coord', field('name', $.identifier), optional($._index), ':', field('unit', $.declared_unit), ';'),
    input_statement: ($) =>
      seq('input', field('name', $.identifier), optional($._index), ':', field('unit', $.declared_unit), ';'),
    prescribed_statement: ($) =>
      seq(
        'prescribed',
        field('name', $.identifier),
        optional($._index),
        ':',
        field('unit', $.declared_unit),
        optional($._value),
        ';',
      ),
    const_statement: ($) =>
      seq(
        'const',
        field('name', $.identifier),
        optional($._index),
        optional(seq(':', field('unit', $.declared_unit))),
        $._value,
        ';',
      ),
    _value: ($) => seq('=', field('value', $._expression)),
    _index: ($) => seq('[', field('index', $._expression), ']'),

    declared_unit: ($) => seq($._unit_factor, repeat(seq(choice('*', '/'), $._unit_factor))),
    _unit_factor: ($) =>
      choice(
        $.number,
        seq(alias($.identifier, $.unit_name), optional(seq('^', $.unit_exponent))),
        seq('(', $.declared_unit, ')'),
      ),
    unit_exponent: ($) =>
      choice(seq(optional('-'), $.number), seq('(', optional('-'), $.number, optional(seq('/', $.number)), ')')),

    // ---- names

    function_statement: ($) =>
      seq('fn', field('name', $.identifier), field('parameters', $.parameters), $._value, ';'),
    parameters: ($) => seq('(', listed($.identifier), ')'),
    let_statement: ($) =>
      seq('let', optional('mut'), field('name', $.identifier), choice($._value, repeat1($._index)), ';'),
    assignment: ($) => seq(field('name', $._assignable), repeat($._index), $._value, ';'),
    // Words that begin statements of their own and may be names all the same.
    _assignable: ($) => choice($.identifier, ...['gravity', 'part', 'shape'].map((word) => alias(word, $.identifier))),

    // ---- what a mechanism is made of

    energy_statement: ($) =>
      seq(choice('kinetic', 'potential', 'dissipation', 'lagrangian'), '+=', field('value', $._expression), ';'),
    force_statement: ($) =>
      seq(
        'force',
        field('coordinate', $.identifier),
        optional($._index),
        '+=',
        field('value', $._expression),
        ';',
      ),
    force_at_statement: ($) =>
      seq('force', 'at', field('point', $._expression), '+=', field('value', $._expression), ';'),
    torque_statement: ($) =>
      seq('torque', 'on', field('pose', $._expression), '+=', field('value', $._expression), ';'),
    gravity_statement: ($) => seq('gravity', field('acceleration', $._expression), ';'),
    reaction_statement: ($) =>
      seq('reaction', field('name', $.identifier), optional($._index), 'at', field('pose', $._expression), ';'),
    shape_statement: ($) =>
      seq(
        'shape',
        field('pose', $._expression),
        '+=',
        field('kind', $.identifier),
        '(',
        optional(choice($.path, seq(optional(seq($.path, ',')), $._expression, repeat(seq(',', $._expression))))),
        ')',
        ';',
      ),
    constraint_statement: ($) =>
      seq(
        'constraint',
        field('name', $.identifier),
        optional($._index),
        ':',
        field('left', $._expression),
        '=',
        field('right', $._expression),
        ';',
      ),
    output_statement: ($) =>
      seq(
        'output',
        field('name', $.identifier),
        optional($._index),
        $._value,
        optional(seq(',', 'jacobian_rate')),
        ';',
      ),
    part_statement: ($) =>
      seq('part', field('name', $.identifier), field('parameters', $.parameters), field('body', $.block)),
    instance: ($) =>
      seq(
        field('part', $.identifier),
        field('name', $.identifier),
        optional($._index),
        field('arguments', $.arguments),
        ';',
      ),
    for_statement: ($) =>
      seq(
        'for',
        field('variable', $.identifier),
        'in',
        field('start', $._expression),
        '..',
        field('end', $._expression),
        field('body', $.block),
      ),
    if_statement: ($) =>
      seq(
        'if',
        field('condition', $._expression),
        field('body', $.block),
        optional(seq('else', field('alternative', choice($.if_statement, $.block)))),
      ),

    // ---- expressions

    _expression: ($) =>
      choice(
        $.number,
        $.quantity,
        $.identifier,
        $.call,
        $.method_call,
        $.member,
        $.element,
        $.array,
        $.parenthesized,
        $.conditional,
        $.unary,
        $.binary,
      ),

    quantity: ($) => prec(PREC.postfix, seq($.number, $.unit)),
    call: ($) => prec(PREC.postfix, seq(field('function', $.identifier), field('arguments', $.arguments))),
    arguments: ($) => seq('(', listed($._expression), ')'),
    member: ($) => prec(PREC.postfix, seq(field('value', $._expression), '.', field('name', $.identifier))),
    method_call: ($) =>
      prec(
        PREC.postfix,
        seq(field('value', $._expression), '.', field('method', $.identifier), field('arguments', $.arguments)),
      ),
    element: ($) => prec(PREC.postfix, seq(field('value', $._expression), $._index)),
    array: ($) => seq('[', listed($._expression), ']'),
    parenthesized: ($) => seq('(', $._expression, ')'),
    conditional: ($) =>
      prec(
        PREC.postfix,
        seq(
          'if',
          field('condition', $._expression),
          '{',
          field('then', $._expression),
          '}',
          'else',
          choice(field('else', $.conditional), seq('{', field('else', $._expression), '}')),
        ),
      ),

    unary: ($) => prec(PREC.sign, seq(field('operator', choice('-', '!')), field('operand', $._expression))),
    binary: ($) =>
      choice(
        ...[
          [PREC.or, '||'],
          [PREC.and, '&&'],
          [PREC.compare, choice('<', '<=', '>', '>=', '==', '!=')],
          [PREC.sum, choice('+', '-')],
          [PREC.product, choice('*', '/')],
        ].map(([level, operator]) =>
          prec.left(
            level,
            seq(field('left', $._expression), field('operator', operator), field('right', $._expression)),
          ),
        ),
        prec.right(
          PREC.power,
          seq(field('left', $._expression), field('operator', '^'), field('right', $._expression)),
        ),
      ),

    identifier: (_) => /[A-Za-z_][A-Za-z0-9_]*/,
  },
});
