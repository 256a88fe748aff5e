#!/usr/bin/env bash
# Checks bramah.lua and the language server in a real Neovim: test.sh [BRAMAH]
set -euo pipefail
bramah=$(realpath "$(command -v "${1:-bramah}")")
here=$(cd "$(dirname "$0")" && pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

# one name is wrong, the line is laid out badly
cat > "$folder/Press.mo" <<'MO'
model Press "A pump fills a volume, a relief valve limits the pressure"
  inner Oil.ISOVG46 oil "Öl";
  Hydraulic.Tank tank;
     Hydraulic.FlowSource pump(q=1e-4);
  Hydraulic.Volume volume(V = 0.5e-3);
  Hydraulic.RelifValve relief(p_set = 150e5);
equation
  connect(pump.port, volume.port);
  connect(volume.port, relief.port_a);
  connect(relief.port_b, tank.port);
  annotation(experiment(StopTime = 1));
end Press;
MO

cd "$folder"
export BRAMAH=$bramah HOME=$folder XDG_CACHE_HOME=$folder/cache XDG_STATE_HOME=$folder/state XDG_DATA_HOME=$folder/data
status=0
timeout 120 nvim --headless --clean -n --cmd "set runtimepath^=$here" -S "$here/test.lua" -c 'cquit 1' 2>&1 || status=1
echo
exit "$status"
