//! `cargo xtask lsp`: how soon the language server answers.

use super::{Outcome, root, run};
use std::io::{BufRead, BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

/// Lines of the document.
const LINES: usize = 2_000;
/// Edits that are measured.
const ROUNDS: usize = 300;

/// What is promised, at the median and at 95 of 100, in milliseconds.
const DIAGNOSTICS: [f64; 2] = [20.0, 50.0];
const COMPLETION: [f64; 2] = [10.0, 30.0];

/// Measures a built command on an edited document of 2 000 lines.
pub fn latency(arguments: &[String]) -> Outcome {
    if !arguments.is_empty() {
        return Err("cargo xtask lsp takes no arguments".into());
    }
    let root = root()?;
    run(Command::new("cargo").args(["build", "--quiet", "--release", "--bin", "rtc"]).current_dir(&root))?;
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root.join("target"), Into::into);
    let mut client = Client::start(&target.join("release/rtc")).map_err(|error| error.to_string())?;
    let mut met = true;
    for (what, bars, times) in [
        ("edit to diagnostics", DIAGNOSTICS, client.diagnostics()),
        ("completion behind an edit", COMPLETION, client.completions()),
    ] {
        let mut times = times.map_err(|error| error.to_string())?;
        times.sort();
        let at = |share: f64| times[(share * (times.len() - 1) as f64) as usize].as_secs_f64() * 1e3;
        let [half, most] = [at(0.5), at(0.95)];
        println!("{what}: {half:.1} ms at p50, {most:.1} ms at p95 (wanted: {} and {})", bars[0], bars[1]);
        met &= half <= bars[0] && most <= bars[1];
    }
    if met { Ok(()) } else { Err("slower than is promised; is the machine idle?".into()) }
}

/// An editor that types.
struct Client {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    version: usize,
}

impl Client {
    /// Starts the server, and opens the document.
    fn start(rtc: &std::path::Path) -> std::io::Result<Client> {
        let mut child = Command::new(rtc).arg("lsp").stdin(Stdio::piped()).stdout(Stdio::piped()).spawn()?;
        let missing = || std::io::Error::other("the server has no pipes");
        let input = child.stdin.take().ok_or_else(missing)?;
        let output = BufReader::new(child.stdout.take().ok_or_else(missing)?);
        let mut client = Client { child, input, output, version: 1 };
        client.send(r#""id":0,"method":"initialize","params":{"capabilities":{}}"#)?;
        client.wait(r#""id":0"#)?;
        client.send(r#""method":"initialized","params":{}"#)?;
        let text = document().replace('\\', "\\\\").replace('"', "\\\"").replace('\n', "\\n");
        client.send(&format!(
            r#""method":"textDocument/didOpen","params":{{"textDocument":{{"uri":"untitled:a.rt","languageId":"rt","version":1,"text":"{text}"}}}}"#
        ))?;
        client.wait("publishDiagnostics")?;
        Ok(client)
    }

    /// From an edit until it is known what is wrong.
    fn diagnostics(&mut self) -> std::io::Result<Vec<Duration>> {
        let once = |client: &mut Client, round: usize| {
            let start = Instant::now();
            client.edit(round)?;
            let version = format!(r#""version":{}"#, client.version);
            client.wait(&version)?;
            Ok(start.elapsed())
        };
        (0..ROUNDS).map(|round| once(self, round)).collect()
    }

    /// From a question behind an edit until its answer.
    fn completions(&mut self) -> std::io::Result<Vec<Duration>> {
        let once = |client: &mut Client, round: usize| {
            client.edit(round)?;
            let start = Instant::now();
            let id = 1_000 + round;
            let line = line_of(round);
            client.send(&format!(
                r#""id":{id},"method":"textDocument/completion","params":{{"textDocument":{{"uri":"untitled:a.rt"}},"position":{{"line":{line},"character":9}}}}"#
            ))?;
            // What is wrong may be known before the answer is.
            let (answer, version) = (format!(r#""id":{id},"#), format!(r#""version":{}"#, client.version));
            let taken = match client.wait_for_either([&answer, &version])? {
                0 => {
                    let taken = start.elapsed();
                    client.wait(&version)?;
                    taken
                }
                _ => {
                    client.wait(&answer)?;
                    start.elapsed()
                }
            };
            Ok(taken)
        };
        (0..ROUNDS).map(|round| once(self, round)).collect()
    }

    /// Types a digit into a radius, or takes it back.
    fn edit(&mut self, round: usize) -> std::io::Result<()> {
        self.version += 1;
        let line = line_of(round / 2);
        let (end, text) = if round.is_multiple_of(2) { (17, "1") } else { (18, "") };
        self.send(&format!(
            r#""method":"textDocument/didChange","params":{{"textDocument":{{"uri":"untitled:a.rt","version":{}}},"contentChanges":[{{"range":{{"start":{{"line":{line},"character":17}},"end":{{"line":{line},"character":{end}}}}},"text":"{text}"}}]}}"#,
            self.version
        ))
    }

    fn send(&mut self, fields: &str) -> std::io::Result<()> {
        let body = format!(r#"{{"jsonrpc":"2.0",{fields}}}"#);
        write!(self.input, "Content-Length: {}\r\n\r\n{body}", body.len())?;
        self.input.flush()
    }

    /// Passes over messages until one holds some words.
    fn wait(&mut self, words: &str) -> std::io::Result<()> {
        self.wait_for_either([words]).map(|_| ())
    }

    /// Passes over messages until one holds some of these words, and tells which.
    fn wait_for_either<const N: usize>(&mut self, words: [&str; N]) -> std::io::Result<usize> {
        loop {
            let mut length = 0;
            loop {
                let mut line = String::new();
                if self.output.read_line(&mut line)? == 0 {
                    return Err(std::io::Error::other("the server has ended"));
                }
                match line.trim_end().strip_prefix("Content-Length: ") {
                    Some(value) => length = value.parse().map_err(std::io::Error::other)?,
                    None if line.trim_end().is_empty() => break,
                    None => {}
                }
            }
            let mut body = vec![0; length];
            self.output.read_exact(&mut body)?;
            let body = String::from_utf8_lossy(&body);
            if let Some(found) = words.iter().position(|words| body.contains(words)) {
                return Ok(found);
            }
        }
    }
}

impl Drop for Client {
    fn drop(&mut self) {
        // It has nothing to save.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A line of the document that is typed at: the last of eight.
fn line_of(round: usize) -> usize {
    8 * ((round * 37) % (LINES / 8 - 1)) + 9
}

/// What somebody might write, at length: parts, loops and materials, eight lines each.
fn document() -> String {
    let mut text = "material red = diffuse { color: #d94f30 }\nplane { material: red }\n".to_string();
    for n in 0..LINES / 8 {
        text.push_str(&format!(
            "/// One of many.\nmaterial glass{n} = dielectric {{ ior: 1.5, tint: #f0f8ff }}\nlet r{n} = {n}mm + 5cm\n\
             for i in range(3) {{\n  sphere {{ at: (i, {n}, 0)m, radius: r{n}, material: glass{n} }}\n}}\n\
             box {{ at: ({n}, 1, 2)m, size: (10, 20, 30)cm }}\nsphere {{ radius: 12cm, at: (0, {n}, 5)m }}\n"
        ));
    }
    text
}
