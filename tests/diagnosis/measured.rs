//! The diagnosis on the measured benches of which the recordings are public: what was left out of the nominal model is
//! found, and beside the complete model nothing is claimed. Skipped where the recordings are not at hand.

#![allow(clippy::disallowed_methods, reason = "tests read their own files")]
#![allow(clippy::unwrap_used, reason = "tests")]
#![allow(clippy::print_stdout, reason = "a test without its data says so")]

use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// The verdict on a bench with a class of its package, the nominal one or the complete one.
fn verdict(bench: &str, class: &str, recordings: &str) -> Option<Value> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let data = root.join("../shared/data").join(recordings);
    if !data.is_dir() {
        println!("skipped: no folder {}", data.display());
        return None;
    }
    let folder = tempfile::tempdir().unwrap();
    let study = std::fs::read_to_string(root.join("models").join(bench).join("gap.toml")).unwrap();
    let own = folder.path().join("gap.toml");
    std::fs::write(&own, study.replace(&format!("{bench}.Nominal"), &format!("{bench}.{class}"))).unwrap();
    let said =
        Command::new(env!("CARGO_BIN_EXE_bramah")).arg("gap").arg(&own).arg("--data").arg(&data).output().unwrap();
    assert!(said.status.success(), "{}", String::from_utf8_lossy(&said.stderr));
    Some(serde_json::from_slice(&said.stdout).unwrap())
}

/// The first effect is of one of these families at this place, and closes this part of the held gap, sensors' noise included.
fn finds(bench: &str, recordings: &str, families: &[&str], place: &str, closes: f64) {
    let Some(verdict) = verdict(bench, "Nominal", recordings) else { return };
    let first = &verdict["effects"][0];
    assert!(first["family"].as_str().is_some_and(|f| families.contains(&f)), "{first:#}");
    assert_eq!(first["places"][0]["place"].as_str(), Some(place), "{first:#}");
    assert!(first["closes_alone"].as_f64().unwrap() > closes, "{first:#}");
}

/// No effect of another family is named.
fn names_only(bench: &str, recordings: &str, families: &[&str]) {
    let Some(verdict) = verdict(bench, "Nominal", recordings) else { return };
    for effect in verdict["effects"].as_array().unwrap() {
        assert!(effect["family"].as_str().is_some_and(|f| families.contains(&f)), "{effect:#}");
    }
}

/// No effect is claimed that closes more than a tenth of the held gap.
fn claims_nothing(bench: &str, recordings: &str) {
    let Some(verdict) = verdict(bench, "Complete", recordings) else { return };
    for effect in verdict["effects"].as_array().unwrap() {
        assert!(effect["closes_alone"].as_f64().is_none_or(|c| c < 0.1), "{effect:#}");
    }
}

#[test]
fn coupled_drives() {
    finds("CoupledDrives", "ced_coupled_drives", &["sensor_rectification"], "y", 0.65);
    claims_nothing("CoupledDrives", "ced_coupled_drives");
}

#[test]
fn cascaded_tanks() {
    // overflow and dead zone only work together, and one recording has few independent samples: nothing is sure
    names_only("CascadedTanks", "cascaded_tanks", &["overflow", "dead_zone"]);
    claims_nothing("CascadedTanks", "cascaded_tanks");
}

#[test]
fn positioning_axis() {
    // dry friction, in Dahl's form where that is a family of its own
    finds("Emps", "emps", &["dry_friction", "hysteresis"], "motor.flange", 0.5);
    claims_nothing("Emps", "emps");
}
