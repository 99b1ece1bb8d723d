//! Programs of a newer Debian than this machine may have: unpacked into a folder, and run there as in a machine of their own.

use super::{Outcome, fresh, run};
use std::path::{Path, PathBuf};
use std::process::Command;

/// Which Debian.
const SUITE: &str = "forky";

/// Makes folders of this machine visible below another root, and runs a program there.
const INSIDE: &str = r#"
root=$1; shift
while [ "$1" != -- ]; do mkdir -p "$root$1"; mount --rbind "$1" "$root$1"; shift; done
shift
exec chroot "$root" env -C "$PWD" SHELL=/bin/sh "$@"
"#;

/// A folder with programs, and what of this machine they see.
pub struct Newer {
    root: PathBuf,
    shared: Vec<PathBuf>,
}

impl Newer {
    /// Has packages at hand, and what they need, in a folder; programs see those folders of this machine that are shared.
    pub fn with(folder: &Path, packages: &[&str], shared: &[&Path]) -> Result<Self, String> {
        let root = folder.join("root");
        let ready = folder.join("ready");
        let wanted = format!("{SUITE} {}", packages.join(" "));
        if std::fs::read_to_string(&ready).is_ok_and(|there| there == wanted) {
            let shared = shared.iter().map(PathBuf::from).collect();
            return Ok(Self { root, shared });
        }
        fresh(folder)?;
        unpack(folder, &root, packages)?;
        write(&ready, &wanted)?;
        Self::with(folder, packages, shared)
    }

    /// The words of a command line that runs a program there, in the same folder as here.
    pub fn line(&self, program: &[&str]) -> Vec<String> {
        let unshare = ["unshare", "--user", "--map-root-user", "--mount", "sh", "-ec", INSIDE, "sh"];
        let mut line: Vec<String> = unshare.map(String::from).into();
        line.push(self.root.display().to_string());
        line.extend(["/dev", "/proc"].map(String::from));
        line.extend(self.shared.iter().map(|folder| folder.display().to_string()));
        line.push("--".into());
        line.extend(program.iter().map(|word| word.to_string()));
        line
    }
}

/// Fetches packages by an apt of their own, which knows nothing of this machine's, and unpacks them.
fn unpack(folder: &Path, root: &Path, packages: &[&str]) -> Outcome {
    let make = |path: &Path| {
        std::fs::create_dir_all(path).map_err(|error| format!("cannot make {}: {error}", path.display()))
    };
    let archives = folder.join("cache/archives");
    for path in [folder.join("lists/partial"), folder.join("parts"), archives.join("partial")] {
        make(&path)?;
    }
    let key = "/usr/share/keyrings/debian-archive-keyring.gpg";
    let sources = format!("deb [signed-by={key}] {} {SUITE} main\n", mirror()?);
    write(&folder.join("sources.list"), &sources)?;
    write(&folder.join("status"), "")?;
    let at = folder.display();
    let settings = format!(
        "Dir::Etc::sourcelist \"{at}/sources.list\";\nDir::Etc::sourceparts \"{at}/parts\";\n\
         Dir::State::lists \"{at}/lists\";\nDir::State::status \"{at}/status\";\nDir::Cache \"{at}/cache\";\n\
         APT::Install-Recommends \"false\";\nAPT::Sandbox::User \"root\";\n"
    );
    let settings_file = folder.join("apt.conf");
    write(&settings_file, &settings)?;
    let apt = || {
        let mut command = Command::new("apt-get");
        command.env("APT_CONFIG", &settings_file).args(["-qq", "-y", "-o", "Debug::NoLocking=true"]);
        command
    };
    run(apt().arg("update"))?;
    run(apt().args(["install", "--download-only"]).args(packages))?;
    // Old places of what is below /usr by now.
    for name in ["bin", "sbin", "lib", "lib64"] {
        make(&root.join("usr").join(name))?;
        link(&format!("usr/{name}"), &root.join(name))?;
    }
    for name in ["dev", "proc", "tmp"] {
        make(&root.join(name))?;
    }
    let fetched = std::fs::read_dir(&archives).map_err(|error| error.to_string())?;
    for package in fetched.filter_map(Result::ok).filter(|entry| entry.path().extension().is_some()) {
        run(Command::new("dpkg-deb").arg("-x").arg(package.path()).arg(root))?;
    }
    // What a compiler is called is settled when it is installed.
    link("gcc", &root.join("usr/bin/cc"))?;
    std::fs::remove_dir_all(folder.join("cache")).map_err(|error| error.to_string())
}

/// Where this machine has its Debian from.
fn mirror() -> Result<String, String> {
    let known = || {
        let asked = ["indextargets", "--format", "$(REPO_URI)", "Created-By: Packages", "Label: Debian"];
        let output = Command::new("apt-get").args(asked).output().ok()?;
        String::from_utf8_lossy(&output.stdout).lines().next().map(String::from)
    };
    match known() {
        Some(address) => Ok(address),
        None => {
            run(Command::new("apt-get").args(["update", "-qq"]))?;
            known().ok_or_else(|| "apt knows no mirror of Debian".into())
        }
    }
}

fn link(target: &str, at: &Path) -> Outcome {
    std::os::unix::fs::symlink(target, at).map_err(|error| format!("cannot link {}: {error}", at.display()))
}

fn write(path: &Path, text: &str) -> Outcome {
    std::fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))
}
