#!/bin/sh
# structure.sh [-v]: measures of the source tree, one per line; exit code 1 if
# one is beyond its bound. With -v what is counted is named. Run it at the top.
#
#   upward includes   of headers from a folder that comes later in source/LAYERS
#   folder circles    pairs of folders that include each other
#   unformatted files that clang-format 14 would change, where it is installed
#   long files        above 500 lines, also of tests
#   large classes     above 20 data members or 25 member functions, plain data
#                     excepted; how they are counted: tests/class_sizes.awk
set -eu
verbose=0
[ "${1:-}" != -v ] || verbose=1

unformatted=
if command -v clang-format-14 >/dev/null 2>&1; then
  unformatted=$(find source include tests -name '*.h' -o -name '*.cc' | sort |
    xargs clang-format-14 --dry-run 2>&1 |
    sed -n 's/^\([^:]*\):[0-9]*:[0-9]*: .*/\1/p' | sort -u | tr '\n' ' ')
fi

# the counting of classes, on declarations that are easily misread
sizes=$(awk -f tests/class_sizes.awk <<'CLASSES'
  enum class Kind { one, two };
  template <int dim, class Other = std::map<int, std::vector<int>>>
  class Outer final : public Base<dim>, private Other // class Comment {
  {
  public:
    using Name = int;
    static constexpr int n = dim == 2 ? 3 : 6;
    explicit Outer(const int a) : a_{a}, text_("};") { set(); }
    Outer(const Outer &) = delete;
    ~Outer() override = default;
    template <typename T> T of(const std::map<int, T> &x = {}) const;
    bool operator<(const Outer &other) const { return a_ < other.a_; }
    struct Inner {
      explicit Inner(int);
      double x = 0., y{1.};
      std::array<int, 2> z{{1, 2}};
    };
  private:
    void set() /* one; two; */
    {
      struct Local { int q; };
      if (a_ > 0) { a_ = '}'; }
    }
    int a_, b_ = size(1, 2);
    const std::function<void(int, double)> call_;
    std::map<int, std::vector<Inner>> inner_;
    std::string text_ = R"(; int raw; ")";
  };
  struct Outer<2>::Later : Inner {
    void act();
  };
CLASSES
)
[ "$(echo "$sizes" | sed 's/^.*:[0-9]* //')" = "Inner 3 1 data
Outer 5 4 class
Outer::Later 0 1 class" ] || { echo "classes are counted wrongly: $sizes"; exit 1; }

# the input of a scene is plain data: its few functions answer what it says
large=$(find source include/nsfd -name '*.h' -o -name '*.cc' | sort |
  xargs awk -f tests/class_sizes.awk |
  awk '$5 == "class" && ($3 > 20 || $4 > 25) && $1 !~ /\/scene\/[^\/]*$/ {
    print $1, $2 ": " $3 " data members, " $4 " functions;" }' | tr '\n' ' ')

long=$(find source include/nsfd tests -name '*.h' -o -name '*.cc' | sort |
  xargs awk 'FNR == 501 { print FILENAME }' | tr '\n' ' ')

find source include/nsfd -name '*.h' -o -name '*.cc' | sort |
  xargs awk -v verbose="$verbose" -v unformatted="$unformatted" \
    -v long="$long" -v large="$large" '
    function folder(path) {
      sub(/^source\//, "", path)
      sub(/^include\/nsfd\//, "", path)
      sub(/^nsfd\//, "", path)
      if (!sub(/\/[^\/]*$/, "", path)) return ""
      while (!(path in rank))
        if (!sub(/\/[^\/]*$/, "", path)) return ""
      return path
    }
    # tells the parts of a list and returns their number
    function count(what, list, separator,    part, n, k) {
      sub(/;? *$/, "", list)
      n = split(list, part, separator)
      for (k = 1; k <= n; ++k) tell(what ": " part[k])
      return n
    }
    function tell(text) { if (verbose) print "  " text }
    FNR == 1 { mine = folder(FILENAME) }
    FNR == 1 && mine == "" {
      print FILENAME ": its folder is not in source/LAYERS"; bad = 1
    }
    FILENAME == "source/LAYERS" { next }
    /^[ \t]*#[ \t]*include[ \t]*"/ {
      split($0, part, "\"")
      if (part[2] ~ /^\.\.?\//) {
        print FILENAME ": " part[2] " is not named from source/"; bad = 1
      }
      its = part[2] ~ /\// ? folder(part[2]) : mine
      if (its == "") { print FILENAME ": where is " part[2] "?"; bad = 1 }
      if (its == mine) next
      if (rank[its] > rank[mine]) {
        ++upward; tell("upward: " FILENAME " includes " part[2])
      }
      if (!((mine, its) in uses)) {
        uses[mine, its] = 1
        if ((its, mine) in uses) { ++circles; tell("circle: " mine " and " its) }
      }
    }
    BEGIN {
      while ((getline line < "source/LAYERS") > 0)
        if (line !~ /^#/ && split(line, word, " ") > 0) rank[word[1]] = ++n
    }
    END {
      printf "upward includes %d\n", upward
      printf "folder circles %d\n", circles
      printf "unformatted files %d\n", count("unformatted", unformatted, " ")
      printf "long files %d\n", count("long", long, " ")
      printf "large classes %d\n", count("large", large, ";")
      exit bad || upward || circles || unformatted != "" || long != "" ||
        large != ""
    }'
