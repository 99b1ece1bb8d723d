//! Who may ask, and for what.
//!
//! Any page that a browser shows can send requests to this machine, and a name that its owner points here makes them look
//! as if they came from here ("DNS rebinding"). So a request must name this server as its host, come from no other page,
//! and know the secret.

use super::save::Saved;
use super::token::is_token;
use axum::http::request::Parts;
use axum::http::{HeaderMap, Method, StatusCode, header};
use std::net::SocketAddr;

/// Knows who may ask.
pub struct Guard {
    /// As a browser writes them in `Host`.
    hosts: Vec<String>,
    token: String,
}

/// What is asked for by somebody who may.
#[derive(Debug, PartialEq)]
pub enum Wish {
    /// Another address.
    Redirect(String),
    /// A file of the page.
    Asset(&'static Asset),
    /// The picture as a file.
    Picture(Saved),
    /// The talk with a page.
    Socket,
}

/// A file of the page.
#[derive(Debug, PartialEq)]
pub struct Asset {
    name: &'static str,
    /// Its type, for a browser.
    pub media: &'static str,
    /// What it holds.
    pub text: &'static str,
}

/// The port that an address with `http://` means where it names none.
const HTTP_PORT: u16 = 80;

const SCRIPT: &str = "text/javascript; charset=utf-8";

macro_rules! assets {
    ($($name:literal $media:expr,)*) => {
        &[$(Asset { name: $name, media: $media, text: include_str!(concat!("assets/", $name)) },)*]
    };
}

/// All there is to read.
const ASSETS: &[Asset] = assets! {
    "index.html" "text/html; charset=utf-8",
    "page.css" "text/css; charset=utf-8",
    "icon.svg" "image/svg+xml",
    "page.js" SCRIPT,
    "develop.js" SCRIPT,
    "element.js" SCRIPT,
    "film.js" SCRIPT,
    "find.js" SCRIPT,
    "hand.js" SCRIPT,
    "inspect.js" SCRIPT,
    "keys.js" SCRIPT,
    "params.js" SCRIPT,
    "places.js" SCRIPT,
    "said.js" SCRIPT,
    "socket.js" SCRIPT,
    "view.js" SCRIPT,
    "window.js" SCRIPT,
};

impl Guard {
    /// For a server at this address with this secret.
    pub fn new(address: SocketAddr, token: String) -> Guard {
        let mut hosts = vec![address.to_string(), format!("localhost:{}", address.port())];
        if address.port() == HTTP_PORT {
            // Browsers leave it out.
            let bare = |host: &String| host.strip_suffix(&format!(":{HTTP_PORT}")).map(str::to_string);
            hosts.extend(hosts.iter().filter_map(bare).collect::<Vec<_>>());
        }
        Guard { hosts, token }
    }

    /// What is wished, if it may be.
    pub fn wish(&self, parts: &Parts) -> Result<Wish, StatusCode> {
        self.is_ours(&parts.headers)?;
        let wish = self.find(parts.uri.path(), parts.uri.query().unwrap_or(""))?;
        // Every browser says where a socket is asked from.
        if wish == Wish::Socket && !parts.headers.contains_key(header::ORIGIN) {
            return Err(StatusCode::FORBIDDEN);
        }
        match parts.method {
            Method::GET | Method::HEAD => Ok(wish),
            _ => Err(StatusCode::METHOD_NOT_ALLOWED),
        }
    }

    /// Whether host and origin are this server.
    fn is_ours(&self, headers: &HeaderMap) -> Result<(), StatusCode> {
        let ours = |host: &str| self.hosts.iter().any(|ours| host.eq_ignore_ascii_case(ours));
        let mut hosts = headers.get_all(header::HOST).iter();
        let host_is_ours = match (hosts.next(), hosts.next()) {
            (Some(host), None) => host.to_str().is_ok_and(ours),
            _ => false,
        };
        let origin_is_ours = headers.get_all(header::ORIGIN).iter().all(|origin| {
            let host = origin.to_str().ok().and_then(|origin| origin.strip_prefix("http://"));
            host.is_some_and(ours)
        });
        if host_is_ours && origin_is_ours { Ok(()) } else { Err(StatusCode::FORBIDDEN) }
    }

    fn find(&self, path: &str, query: &str) -> Result<Wish, StatusCode> {
        let path = path.strip_prefix('/').ok_or(StatusCode::NOT_FOUND)?;
        let (first, rest) = path.split_once('/').map_or((path, None), |(first, rest)| (first, Some(rest)));
        if !same(first, &self.token) {
            let meant = path.is_empty() || is_token(first) || named(path, query).is_ok();
            return Err(if meant { StatusCode::FORBIDDEN } else { StatusCode::NOT_FOUND });
        }
        match rest {
            None => Ok(Wish::Redirect(format!("/{}/", self.token))),
            Some("") => named("index.html", query),
            Some(name) => named(name, query),
        }
    }
}

/// What a name stands for.
fn named(name: &str, query: &str) -> Result<Wish, StatusCode> {
    if name == "socket" {
        return Ok(Wish::Socket);
    }
    if let Some(saved) = Saved::named(name, query) {
        return saved.map(Wish::Picture);
    }
    ASSETS.iter().find(|asset| asset.name == name).map(Wish::Asset).ok_or(StatusCode::NOT_FOUND)
}

/// Whether two texts are the same, in a time that tells nothing of where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use axum::http::Request;

    const TOKEN: &str = "00112233445566778899aabbccddeeff";

    fn ask(path: &str, headers: &[(&str, &str)]) -> Result<Wish, StatusCode> {
        ask_at("127.0.0.1:4877", path, headers)
    }

    /// Asks a server at another address.
    fn ask_at(address: &str, path: &str, headers: &[(&str, &str)]) -> Result<Wish, StatusCode> {
        let mut request = Request::builder().uri(path);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        guard(address).wish(&request.body(()).unwrap().into_parts().0)
    }

    fn guard(address: &str) -> Guard {
        Guard::new(address.parse().unwrap(), TOKEN.into())
    }

    fn at(path: &str) -> Result<Wish, StatusCode> {
        ask(path, &[("host", "127.0.0.1:4877")])
    }

    #[test]
    fn who_knows_the_secret_gets_the_page() {
        let Ok(Wish::Asset(page)) = at(&format!("/{TOKEN}/")) else { panic!() };
        assert_eq!(page.name, "index.html");
        for asset in ASSETS {
            assert_eq!(at(&format!("/{TOKEN}/{}", asset.name)), Ok(Wish::Asset(asset)));
        }
        assert_eq!(at(&format!("/{TOKEN}")), Ok(Wish::Redirect(format!("/{TOKEN}/"))));
        assert!(ask(&format!("/{TOKEN}/"), &[("host", "LOCALHOST:4877")]).is_ok());
    }

    #[test]
    fn who_does_not_know_it_gets_nothing() {
        let other = TOKEN.replace('0', "1");
        for path in
            ["/", "/page.js", "/socket", "/picture.png", &format!("/{other}/"), &format!("/{other}/page.js")]
        {
            assert_eq!(at(path), Err(StatusCode::FORBIDDEN), "{path}");
        }
        assert_eq!(at(&format!("/{}/", TOKEN.to_uppercase())), Err(StatusCode::FORBIDDEN));
    }

    #[test]
    fn nothing_else_is_there() {
        let inside = |name: &str| format!("/{TOKEN}/{name}");
        for path in
            ["/../Cargo.toml", "/Cargo.toml", "/etc/passwd", "//", "/favicon.ico", "/%2e%2e/Cargo.toml"]
        {
            assert_eq!(at(path), Err(StatusCode::NOT_FOUND), "{path}");
        }
        for name in
            ["../Cargo.toml", "assets/page.js", "mod.rs", "page.js/", "picture.gif", "/", "page.js%00"]
        {
            assert_eq!(at(&inside(name)), Err(StatusCode::NOT_FOUND), "{name}");
        }
    }

    #[test]
    fn other_hosts_and_other_pages_are_refused() {
        let page = format!("/{TOKEN}/");
        let refused = Err(StatusCode::FORBIDDEN);
        assert_eq!(ask(&page, &[]), refused);
        for host in ["evil.example", "127.0.0.1", "127.0.0.1:80", "evil.example:4877", "[::1]:4877", ""] {
            assert_eq!(ask(&page, &[("host", host)]), refused, "{host}");
        }
        assert_eq!(ask(&page, &[("host", "localhost:4877"), ("host", "evil.example")]), refused);
        for origin in [
            "null",
            "http://evil.example",
            "https://127.0.0.1:4877",
            "http://127.0.0.1:4878",
            "127.0.0.1:4877",
        ] {
            assert_eq!(ask(&page, &[("host", "127.0.0.1:4877"), ("origin", origin)]), refused, "{origin}");
        }
        assert!(ask(&page, &[("host", "127.0.0.1:4877"), ("origin", "http://127.0.0.1:4877")]).is_ok());
    }

    #[test]
    fn the_port_that_browsers_leave_out_is_known() {
        let socket = format!("/{TOKEN}/socket");
        for (address, host) in [
            ("127.0.0.1:80", "127.0.0.1"),
            ("127.0.0.1:80", "localhost"),
            ("127.0.0.1:80", "127.0.0.1:80"),
            ("[::1]:80", "[::1]"),
        ] {
            let headers = [("host", host), ("origin", &format!("http://{host}"))];
            assert_eq!(ask_at(address, &socket, &headers), Ok(Wish::Socket), "{address} {host}");
        }
        let refused = Err(StatusCode::FORBIDDEN);
        for (address, host) in [("127.0.0.1:8080", "127.0.0.1"), ("127.0.0.1:80", "evil.example")] {
            assert_eq!(ask_at(address, &socket, &[("host", host)]), refused, "{address} {host}");
        }
    }

    #[test]
    fn a_socket_says_where_it_is_from() {
        let socket = format!("/{TOKEN}/socket");
        assert_eq!(at(&socket), Err(StatusCode::FORBIDDEN));
        let headers = [("host", "localhost:4877"), ("origin", "http://localhost:4877")];
        assert_eq!(ask(&socket, &headers), Ok(Wish::Socket));
    }

    #[test]
    fn nothing_can_be_sent_but_by_the_socket() {
        let mut parts =
            Request::builder().uri(format!("/{TOKEN}/")).method("POST").body(()).unwrap().into_parts().0;
        parts.headers.insert(header::HOST, "127.0.0.1:4877".parse().unwrap());
        assert_eq!(guard("127.0.0.1:4877").wish(&parts), Err(StatusCode::METHOD_NOT_ALLOWED));
    }
}
