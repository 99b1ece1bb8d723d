#!/usr/bin/env bash
# Hostile sources within 2 GiB of address space and a minute each: refused or read, never a crash.
# Usage: memory.sh RTC ROOT, in an empty folder.
set -euo pipefail
rtc=$1

# expect CODES FILE: checking the file ends with one of the codes.
expect() {
  local code=0
  (ulimit -v 2097152; timeout 60 "$rtc" check "$2" > out 2> said) || code=$?
  case " $1 " in
    *" $code "*) echo "  $2: exit code $code, $(wc -c < said) bytes said" ;;
    *) echo "$2: exit code $code, not one of $1"; head -c 2000 said; exit 1 ;;
  esac
  [ ! -s out ] || { echo "$2: something on standard output"; exit 1; }
  [ "$(wc -c < said)" -lt 100000 ] || { echo "$2: too much was said"; exit 1; }
}

head -c 100000000 /dev/zero | tr '\0' 'x' > long-word.rt
expect 1 long-word.rt
{ echo -n 'sphere { radius: 1m } // '; head -c 100000000 /dev/zero | tr '\0' 'x'; } > long-comment.rt
expect 0 long-comment.rt
{ echo -n 'sphere { radius: 1m '; head -c 100000000 /dev/zero | tr '\0' ' '; echo '}'; } > long-space.rt
expect 0 long-space.rt
for bracket in '(' '{' '[' '-' 'a{' 'f('; do
  { echo -n 'sphere { radius: '; head -c 100000 /dev/zero | sed "s/\\x0/$bracket/g"; } > brackets.rt
  expect 1 brackets.rt
done
{ echo -n 'sphere { radius: '; head -c 100000 /dev/zero | tr '\0' '('; echo -n 1m; head -c 100000 /dev/zero | tr '\0' ')'; echo '}'; } > balanced.rt
expect 1 balanced.rt
head -c 300000000 /dev/zero | tr '\0' ' ' > too-large.rt
expect 1 too-large.rt
# The files are large; the folder is emptied at the next run only.
rm -- *.rt
