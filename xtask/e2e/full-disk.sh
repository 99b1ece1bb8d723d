#!/usr/bin/env bash
# A disk that fills up while a picture is written: a clear error, exit code 2, the earlier picture whole, no rest.
# Usage: full-disk.sh RTC ROOT, in an empty folder.
set -euo pipefail
rtc=$1
disk=$PWD/disk

# Mounting needs leave: as it is, or as root of a namespace of one's own.
if [ -z "${IN_NAMESPACE:-}" ]; then
  if unshare --mount true 2>/dev/null; then
    IN_NAMESPACE=1 exec unshare --mount bash "$0" "$@"
  elif unshare --user --map-root-user --mount true 2>/dev/null; then
    IN_NAMESPACE=1 exec unshare --user --map-root-user --mount bash "$0" "$@"
  fi
  echo "needs leave to mount a tmpfs: run as root, or allow user namespaces" >&2
  exit 1
fi

mkdir "$disk"
mount -t tmpfs -o size=200k tmpfs "$disk"
echo 'sphere { radius: 1m }' > "$disk/ball.rt"
echo 'the picture of yesterday' > "$disk/ball.exr"

code=0
said=$("$rtc" build "$disk/ball.rt" --size 400x400 --samples 1 -o "$disk/ball.png" -o "$disk/ball.exr" -o "$disk/ball.pfm" 2>&1) || code=$?
echo "$said" | sed 's/^/  /'
[ "$code" = 2 ] || { echo "exit code $code, not 2"; exit 1; }
case $said in *"cannot write"*"no space left"*) ;; *) echo "the error is not clear"; exit 1 ;; esac
[ "$(cat "$disk/ball.exr")" = 'the picture of yesterday' ] || { echo "the earlier picture was touched"; exit 1; }
[ "$(ls -A "$disk" | tr '\n' ' ')" = 'ball.exr ball.rt ' ] || { echo "left behind:"; ls -A "$disk"; exit 1; }
