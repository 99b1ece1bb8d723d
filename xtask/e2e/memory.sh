#!/usr/bin/env bash
# Hostile sources and files, and every limit of the reference, within little address space: refused or read, never a crash.
# Usage: memory.sh RTC ROOT, in an empty folder.
set -euo pipefail
rtc=$1
# MiB of address space, and seconds on a busy machine.
cap=2048
patience=120

# expect EXIT CODE FILE [FLAG…]: checking the file ends so, with that code or, where it is -, without an error.
expect() {
  local wanted=$1 code=$2 file=$3 exit=0
  shift 3
  (ulimit -v $((cap << 10)); timeout "$patience" "$rtc" check "$file" "$@" > out 2> said) || exit=$?
  if [ "$exit" != "$wanted" ] && [ "$wanted" != any ] || [ "$exit" -gt 1 ]; then
    echo "$file $*: exit code $exit, not $wanted"; head -c 2000 said; exit 1
  fi
  if [ "$code" != - ] && ! grep -q "^$code " said; then
    echo "$file $*: no $code"; head -c 2000 said; exit 1
  fi
  [ ! -s out ] || { echo "$file $*: something on standard output"; exit 1; }
  [ "$(wc -c < said)" -lt 100000 ] || { echo "$file $*: too much was said"; exit 1; }
  checked=$((checked + 1))
}
checked=0
done_with() { echo "  $1: $checked within $cap MiB"; checked=0; }

# Texts.
head -c 100000000 /dev/zero | tr '\0' 'x' > long-word.rt
expect 1 E0001 long-word.rt
{ echo -n 'sphere { radius: 1m } // '; head -c 100000000 /dev/zero | tr '\0' 'x'; } > long-comment.rt
expect 0 - long-comment.rt
{ echo -n 'sphere { radius: 1m '; head -c 100000000 /dev/zero | tr '\0' ' '; echo '}'; } > long-space.rt
expect 0 - long-space.rt
for bracket in '(' '{' '[' '-' 'a{' 'f('; do
  { echo -n 'sphere { radius: '; head -c 100000 /dev/zero | sed "s/\\x0/$bracket/g"; } > brackets.rt
  expect 1 - brackets.rt
done
{ echo -n 'sphere { radius: '; head -c 100000 /dev/zero | tr '\0' '('; echo -n 1m; head -c 100000 /dev/zero | tr '\0' ')'; echo '}'; } > balanced.rt
expect 1 E0406 balanced.rt
expect 1 E0406 balanced.rt --max-brackets 4096
head -c 300000000 /dev/zero | tr '\0' ' ' > too-large.rt
expect 1 E0406 too-large.rt
for i in 1 2 3 4 5; do
  head -c 1000000 /dev/zero | tr '\0' ' ' > "import$i.rt"
  echo "import \"import$i.rt\" as import$i"
done > imports.rt
echo 'sphere { radius: 1m }' >> imports.rt
expect 0 - imports.rt
expect 1 E0406 imports.rt --max-source 1
done_with "long and deep texts"
# The files are large; the folder is emptied at the next run only.
rm -- *.rt

# What is evaluated.
for ((i = 0; i < 70; i++)); do
  printf 'import "level%d.rt" as next\nsphere { radius: 1m }\n' $((i + 1)) > "level$i.rt"
done
echo 'sphere { radius: 1m }' > level70.rt
expect 1 E0406 level0.rt
expect 0 - level0.rt --max-levels 80
{
  echo 'fn f0(x: number) -> number = x'
  for ((i = 1; i < 70; i++)); do echo "fn f$i(x: number) -> number = f$((i - 1))(x)"; done
  echo 'sphere { radius: 1m * f69(1) }'
} > calls.rt
expect 1 E0406 calls.rt
expect 0 - calls.rt --max-levels 80
echo 'for i in range(1000001) { }' > items.rt
expect 1 E0406 items.rt
hundred() { printf "$1, %.0s" {1..99}; echo "$1"; }
{
  echo "fn row(x: number) -> [number] = [$(hundred x)]"
  echo "fn rows(x: number) -> [[number]] = [$(hundred 'row(x)')]"
  echo 'let all = rows(1) let more = rows(2)' | sed 's/ let/\nlet/'
  echo 'sphere { radius: 1m * all[0][0] * more[0][0] }'
} > lists.rt
expect 0 - lists.rt
expect 1 E0406 lists.rt --max-items 1000
echo 'for i in range(1000) { for j in range(1001) { sphere { radius: 1cm, at: (i, j, 0)m } } }' > things.rt
expect 1 E0406 things.rt --max-things 1000000
{
  echo 'let a0 = group { sphere { radius: 1cm } }'
  for ((i = 1; i <= 30; i++)); do echo "let a$i = group { a$((i - 1)) {}, a$((i - 1)) {} }"; done
  echo 'a30 {}'
} > copies.rt
expect 1 E0406 copies.rt --max-things 1000000
echo 'for i in range(1000000) { for j in range(1000000) { } }' > steps.rt
expect 1 E0406 steps.rt --max-steps 100000000
for size in '(10001, 10000)' '(4000000000, 4000000000)'; do
  echo "sphere { radius: 1m } render { size: $size }" > pixels.rt
  expect 1 - pixels.rt
done
done_with "what is evaluated"

rm -- *.rt

# Files that are not what they say, or more than they seem.
cap=1024
python3 "$2/xtask/e2e/hostile.py"
for scene in refused-*.rt; do expect 1 - "$scene"; done
for scene in any-*.rt; do expect any - "$scene"; done
done_with "hostile pictures, meshes and tables"
# Of 32 Mi pixels, a picture takes 384 MiB as it is kept, and up to as much beside that while it is read.
cap=1280
for scene in read-*.rt; do expect 0 - "$scene"; done
done_with "the largest pictures"
rm -- *

# A million balls, each of its own material, a tenth of the most there may be: within a tenth of what these take.
cap=1024
exit=0
(ulimit -v $((cap << 10)); timeout 600 "$rtc" build "$2/xtask/compare/balls.rt" --set count=1000000 --samples 1 --size 64x48 \
  -o balls.png) || exit=$?
[ "$exit" = 0 ] || { echo "a million balls: exit code $exit"; exit 1; }
echo "  a million balls within $cap MiB"
