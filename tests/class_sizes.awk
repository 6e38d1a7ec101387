# Data members and member functions of every class of C++ files, a line each:
#   file:line name data functions kind
# kind is `data` for a struct without member functions other than constructors,
# destructors, operators and serialize(), else `class`. Constants (static data),
# deleted and defaulted functions do not count; members of base classes, of
# nested classes and classes inside functions do not either. It reads tokens,
# not the grammar: enough for code that clang-format has been over.

# the code of a line without comments, strings, characters
function code_of(line,    result, c, end) {
  result = ""
  while (line != "") {
    if (raw) {
      end = index(line, raw)
      if (!end) return result
      line = substr(line, end + length(raw)); raw = ""
    } else if (comment) {
      end = index(line, "*/")
      if (!end) return result
      line = substr(line, end + 2); comment = 0
    } else if (match(line, /^[^\/"'R0-9A-Za-z_]+/)) {
      result = result substr(line, 1, RLENGTH); line = substr(line, RLENGTH + 1)
    } else if (match(line, /^R"[^( ]*\(/)) {
      raw = ")" substr(line, 3, RLENGTH - 3) "\""
      result = result " text "; line = substr(line, RLENGTH + 1)
    } else if (match(line, /^[0-9][0-9A-Za-z_.']*/)) {
      result = result "0"; line = substr(line, RLENGTH + 1)
    } else if (match(line, /^[A-Za-z_][0-9A-Za-z_]*/)) {
      result = result substr(line, 1, RLENGTH); line = substr(line, RLENGTH + 1)
    } else if (substr(line, 1, 2) == "//") {
      return result
    } else if (substr(line, 1, 2) == "/*") {
      comment = 1; line = substr(line, 3)
    } else if (match(line, /^"([^"\\]|\\.)*"/) || match(line, /^'([^'\\]|\\.)*'/)) {
      result = result " text "; line = substr(line, RLENGTH + 1)
    } else {
      result = result substr(line, 1, 1); line = substr(line, 2)
    }
  }
  return result
}

# without what stands in <...> and in [...]
function without_brackets(text) {
  gsub(/operator *(<=>|<<=|>>=|<<|>>|<=|>=|->|<|>)/, "operator@", text)
  gsub(/->|<=|>=|<</, " ", text)
  while (gsub(/<[^<>]*>/, " ", text)) {}
  while (gsub(/\[[^][]*\]/, " ", text)) {}
  return text
}

# what a declaration without body is: function, data, or neither
function kind_of(text,    bracket, equal) {
  if (text ~ /(^| )(using|typedef|friend|static_assert|namespace|enum) /) return ""
  if (text ~ /(^| )(class|struct|union) +[A-Za-z_0-9:]+ *$/) return ""
  if (text ~ /operator/) return "function"
  gsub(/(alignas|decltype|noexcept) *\([^()]*\)/, " ", text)
  if (text ~ /\( *\*/) return "data"
  bracket = index(text, "("); equal = index(text, "=")
  if (bracket && (!equal || bracket < equal)) return "function"
  return text ~ /[A-Za-z_0-9]/ ? "data" : ""
}

# a statement of a class has ended
function member(text, has_body,    kind, name) {
  text = without_brackets(text)
  kind = has_body ? "function" : kind_of(text)
  if (kind == "function") {
    if (text ~ /= *(delete|default) *$/) return
    ++functions[depth]
    name = text
    if (name ~ /operator/) return
    sub(/ *\(.*/, "", name); sub(/.*[^A-Za-z_0-9~]/, "", name)
    sub(/^~/, "", name)
    if (name != class_name[depth] && name != "serialize") plain[depth] = 0
  } else if (kind == "data" && text !~ /(^| )static /) {
    while (gsub(/\([^()]*\)/, " ", text)) {}
    data[depth] += 1 + gsub(/,/, ",", text)
  }
}

function open_scope(kind) { scope[++depth] = kind; kept[depth] = statement }

function open_brace(    text, name) {
  if (scope[depth] == "skip") { open_scope("skip"); return }
  if (round) { open_scope("skip"); return }
  text = without_brackets(statement)
  if (text ~ /(^| )(namespace|extern) / && text !~ /\(/) {
    open_scope("space"); statement = ""; return
  }
  if (text ~ /(^| )enum /) { open_scope("skip"); return }
  if (text ~ /(^| )(class|struct|union) / && text !~ /[(=]/) {
    gsub(/ *:: */, "::", text); gsub(/[^:]:[^:].*/, "", text)
    gsub(/ +final *$| +$/, "", text)
    name = text; sub(/.*[^A-Za-z_0-9:]/, "", name)
    open_scope("class")
    class_name[depth] = name == "" ? "unnamed" : name
    class_line[depth] = FNR; plain[depth] = 1; data[depth] = functions[depth] = 0
    statement = ""; return
  }
  # a brace in the list of initialisers of a constructor, or the body
  if (text ~ /\)[^()]*[^:]:[^:]/ && text ~ /[A-Za-z_0-9> ] *$/ &&
      text !~ /\) *$/ && text !~ /\} *$/) { open_scope("skip"); return }
  if (kind_of(text) == "function") {
    if (scope[depth] == "class") member(statement, 1)
    statement = ""; open_scope("skip"); body[depth] = 1; return
  }
  open_scope("skip")
}

function close_brace() {
  if (depth == 0) return
  if (scope[depth] == "class") {
    printf "%s:%d %s %d %d %s\n", FILENAME, class_line[depth],
           class_name[depth], data[depth], functions[depth],
           plain[depth] ? "data" : "class"
    --depth; statement = "struct closed"; return
  }
  statement = kept[depth]
  if (scope[depth] == "space" || body[depth]) statement = ""
  else if (scope[depth - 1] != "skip") statement = statement " }"
  delete body[depth]
  --depth
}

FNR == 1 {
  depth = 0; scope[0] = "space"; statement = ""; round = 0
  comment = 0; raw = ""; directive = 0; split("", body)
}

{
  if (!comment && !raw && (directive || $0 ~ /^[ \t]*#/)) {
    directive = $0 ~ /\\$/; next
  }
  line = code_of($0)
  gsub(/[ \t]+/, " ", line)
  if (scope[depth] != "skip" || line ~ /[{}]/) {
    while (line != "") {
      if (scope[depth] == "skip" ? match(line, /[{}]/) : match(line, /[{}();:]/)) {
        token = substr(line, RSTART, 1)
        if (scope[depth] != "skip") statement = statement substr(line, 1, RSTART - 1)
        line = substr(line, RSTART + 1)
      } else {
        if (scope[depth] != "skip") statement = statement line
        break
      }
      if (token == "{") { saved[depth + 1] = round; open_brace(); round = 0 }
      else if (token == "}") { close_brace(); round = saved[depth + 1] }
      else if (token == "(") { ++round; statement = statement token }
      else if (token == ")") { --round; statement = statement token }
      else if (token == ":") {
        if (!round && statement ~ /^ *(public|protected|private) *$/) statement = ""
        else statement = statement token
      } else if (!round) {
        if (scope[depth] == "class") member(statement, 0)
        statement = ""
      } else statement = statement token
    }
    statement = statement " "
  }
}
