; Names first: what follows is more special.
(identifier) @variable
(number) @number
(unit) @type.builtin
(unit_name) @type.builtin
(path) @string.special.path
[(comment) (block_comment)] @comment
[(doc_comment) (block_doc_comment)] @comment.documentation

[
  "param" "coord" "input" "prescribed" "const" "let" "mut" "fn" "part" "mechanism" "import"
  "kinetic" "potential" "dissipation" "lagrangian" "force" "torque" "gravity" "reaction" "shape" "constraint" "output"
  "at" "on" "positive" "jacobian_rate"
] @keyword
["for" "in"] @keyword.repeat
["if" "else"] @keyword.conditional

(mechanism name: (identifier) @type)
(param_statement name: (identifier) @variable.parameter)
(coord_statement name: (identifier) @property)
(input_statement name: (identifier) @variable.parameter)
(prescribed_statement name: (identifier) @property)
(const_statement name: (identifier) @constant)
(output_statement name: (identifier) @property)
(constraint_statement name: (identifier) @label)
(reaction_statement name: (identifier) @label)
(function_statement name: (identifier) @function)
(part_statement name: (identifier) @function)
(instance part: (identifier) @function)
(parameters (identifier) @variable.parameter)
(call function: (identifier) @function.call)
(method_call method: (identifier) @function.method)
(member name: (identifier) @property)
(attribute) @attribute

((identifier) @constant.builtin (#any-of? @constant.builtin "pi" "deg" "t" "world"))
((call function: (identifier) @function.builtin)
  (#any-of? @function.builtin
    "dt" "sin" "cos" "tan" "asin" "acos" "atan" "sinh" "cosh" "tanh" "exp" "ln" "abs" "signum" "sqrt" "atan2" "hypot"
    "min" "max" "clamp" "dot" "cross" "rot_x" "rot_y" "rot_z" "rotation" "quaternion" "rpy" "translation" "dh"
    "angular_velocity" "diag" "inertia" "particle" "rigid_body" "table" "table_monotone" "table_spline"
    "spring" "coulomb_stribeck" "contact"))

["+" "-" "*" "/" "^" "=" "+=" "<" "<=" ">" ">=" "==" "!=" "&&" "||" "!" ".."] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ";" ":" "."] @punctuation.delimiter
