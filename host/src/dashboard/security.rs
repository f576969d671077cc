//! Who may ask: a web page of another origin, a name that was made to point here, or a program without
//! the token may not.
//!
//! | checked | on | refused with |
//! |---|---|---|
//! | `Host` names this server by address or as localhost | all requests | 403 |
//! | `Origin`, where there is one, is this server | all requests | 403 |
//! | token, in `Authorization: Bearer` or in the query `t` | changes, the socket, live frames, all beyond loopback | 401 |
//! | `Content-Type` is JSON, or of a photo | changes with a body | 415 |
//!
//! The page itself carries the token on loopback, where the browser keeps other origins from reading it;
//! beyond, its address does.

use super::Dashboard;
use super::error::Failure;
use axum::extract::{Request, State};
use axum::http::header::{AUTHORIZATION, CONTENT_LENGTH, CONTENT_TYPE, HOST, ORIGIN};
use axum::http::{HeaderMap, HeaderName, Method, StatusCode};
use axum::middleware::Next;
use axum::response::Response;
use std::hash::{BuildHasher, RandomState};
use std::net::{IpAddr, SocketAddr, UdpSocket};

/// What a camera shows now is for who may drive.
const FRAME: &str = "/api/camera/frame";

/// Where this server is and who may change something.
#[derive(Clone, Debug)]
pub(super) struct Guard {
    pub(super) address: SocketAddr,
    pub(super) token: Token,
}

/// What a page must show to change anything; another one each time the server starts.
#[derive(Clone, PartialEq, Eq)]
pub(super) struct Token(String);

impl std::fmt::Debug for Token {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        out.write_str("Token(…)")
    }
}

impl Token {
    /// 128 bits that nobody can guess.
    pub(super) fn random() -> Self {
        // The seeds of hash maps come from the system's random numbers, and SipHash hides them.
        let half = |number: u8| RandomState::new().hash_one(number);
        Self(format!("{:016x}{:016x}", half(0), half(1)))
    }

    /// The token as text, for the page.
    pub(super) fn text(&self) -> &str {
        &self.0
    }

    /// Compares in a time that does not tell how much of a guess is right.
    fn is(&self, guess: &str) -> bool {
        let (own, guess) = (self.0.as_bytes(), guess.as_bytes());
        let differences = own.iter().zip(guess).fold(0, |sum, (a, b)| sum | (a ^ b));
        own.len() == guess.len() && differences == 0
    }
}

impl Guard {
    /// Where a browser on this computer finds the page.
    pub(super) fn page_address(&self) -> String {
        let ip = match self.address.ip() {
            ip if ip.is_unspecified() => IpAddr::from([127, 0, 0, 1]),
            ip => ip,
        };
        self.address_at(ip)
    }

    /// Where others in the network find it, if they can.
    pub(super) fn network_address(&self) -> Option<String> {
        match self.address.ip() {
            ip if ip.is_loopback() => None,
            ip if ip.is_unspecified() => own_address().map(|ip| self.address_at(ip)),
            ip => Some(self.address_at(ip)),
        }
    }

    fn address_at(&self, ip: IpAddr) -> String {
        let place = SocketAddr::new(ip, self.address.port());
        format!("http://{place}/?t={}", self.token.text())
    }

    /// Whether `host`, as `name:port`, can only be this server: a name other than localhost can be made
    /// to point here by whoever owns it.
    fn is_own_host(&self, host: &str) -> bool {
        let (name, port) = match host.rsplit_once(':') {
            Some((name, port)) if !port.ends_with(']') => (name, port),
            _ => (host, "80"),
        };
        let ip = name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>();
        let named = match ip {
            Ok(ip) => ip.is_loopback() || !self.address.ip().is_loopback(),
            Err(_) => name.eq_ignore_ascii_case("localhost"),
        };
        named && port.parse() == Ok(self.address.port())
    }

    /// What is wrong with a request, if anything.
    fn check(
        &self,
        method: &Method,
        path: &str,
        query: &str,
        headers: &HeaderMap,
    ) -> Option<Failure> {
        let host = text(headers, HOST).unwrap_or_default();
        if !self.is_own_host(host) {
            let help =
                format!("open {}", self.page_address().split('?').next().unwrap_or_default());
            return Some(Failure::new(
                StatusCode::FORBIDDEN,
                "http.host",
                format!("this server is not {host:?}"),
                &help,
            ));
        }
        let origin = headers.get(ORIGIN).map(|value| value.to_str().unwrap_or("?"));
        if let Some(origin) = origin.filter(|origin| *origin != format!("http://{host}")) {
            let message = format!("a page of {origin:?} may not talk to this server");
            return Some(Failure::new(
                StatusCode::FORBIDDEN,
                "http.origin",
                message,
                "use the page of this server",
            ));
        }
        let changes = method == Method::POST;
        let guarded = changes || matches!(path, "/ws" | FRAME) || !self.address.ip().is_loopback();
        // Styles and modules are no secret, and a page cannot give its token along with them.
        let guarded = guarded && !path.starts_with("/page/");
        if guarded && !self.is_known(query, headers) {
            let help = "open the address that wmr serve printed; programs send Authorization: Bearer TOKEN";
            return Some(Failure::new(
                StatusCode::UNAUTHORIZED,
                "http.token",
                "the token is missing or wrong",
                help,
            ));
        }
        if changes && has_body(headers) && !is_content_known(path, text(headers, CONTENT_TYPE)) {
            let help = "send application/json; a photo as image/png, image/jpeg or application/octet-stream";
            return Some(Failure::new(
                StatusCode::UNSUPPORTED_MEDIA_TYPE,
                "http.content_type",
                "this content type is not understood here",
                help,
            ));
        }
        None
    }

    fn is_known(&self, query: &str, headers: &HeaderMap) -> bool {
        let bearer = text(headers, AUTHORIZATION).and_then(|value| value.strip_prefix("Bearer "));
        let in_query = query.split('&').find_map(|pair| pair.strip_prefix("t="));
        [bearer, in_query].into_iter().flatten().any(|guess| self.token.is(guess))
    }
}

/// This computer's address in its network: the one from which it would speak to another. To connect a
/// datagram socket sends nothing.
fn own_address() -> Option<IpAddr> {
    let socket = UdpSocket::bind("0.0.0.0:0").ok()?;
    // An address that is reserved for documents.
    socket.connect("192.0.2.1:9").ok()?;
    let ip = socket.local_addr().ok()?.ip();
    (!ip.is_unspecified() && !ip.is_loopback()).then_some(ip)
}

fn text(headers: &HeaderMap, name: HeaderName) -> Option<&str> {
    headers.get(name).and_then(|value| value.to_str().ok())
}

fn has_body(headers: &HeaderMap) -> bool {
    let length = text(headers, CONTENT_LENGTH);
    length.is_some_and(|length| length != "0") || headers.contains_key("transfer-encoding")
}

fn is_content_known(path: &str, content_type: Option<&str>) -> bool {
    let kind = content_type.and_then(|value| value.split(';').next()).unwrap_or_default().trim();
    let is_picture = kind.starts_with("image/") || kind == "application/octet-stream";
    kind.eq_ignore_ascii_case("application/json") || path == "/api/photo" && is_picture
}

/// Lets a request through only if [`Guard::check`] finds nothing wrong.
pub(super) async fn check(
    State(dashboard): State<Dashboard>,
    request: Request,
    next: Next,
) -> Result<Response, Failure> {
    let uri = request.uri();
    let wrong = dashboard.guard.check(
        request.method(),
        uri.path(),
        uri.query().unwrap_or_default(),
        request.headers(),
    );
    match wrong {
        Some(failure) => Err(failure),
        None => Ok(next.run(request).await),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn guard(address: &str) -> Guard {
        Guard { address: address.parse().unwrap(), token: Token("secret".into()) }
    }

    #[test]
    fn only_what_can_but_be_this_server_is_its_own_host() {
        let own = guard("127.0.0.1:7070");
        for host in ["127.0.0.1:7070", "localhost:7070", "LOCALHOST:7070", "[::1]:7070"] {
            assert!(own.is_own_host(host), "{host}");
        }
        for host in [
            "",
            "evil.example:7070",
            "127.0.0.1",
            "127.0.0.1:7071",
            "192.168.1.2:7070",
            "localhost.evil.example:7070",
            "[::1]",
            "127.0.0.1:7070:7070",
        ] {
            assert!(!own.is_own_host(host), "{host}");
        }
        let open = guard("0.0.0.0:80");
        assert!(open.is_own_host("192.168.1.2") && open.is_own_host("[::1]"));
        assert!(!open.is_own_host("robot.example"), "a name can be made to point here");
    }

    #[test]
    fn the_page_is_where_it_is_said_to_be() {
        let own = guard("127.0.0.1:7070");
        assert_eq!(own.page_address(), "http://127.0.0.1:7070/?t=secret");
        assert_eq!(own.network_address(), None);
        let one = guard("192.168.1.2:80");
        assert_eq!(one.network_address().as_deref(), Some("http://192.168.1.2:80/?t=secret"));
        assert_eq!(guard("0.0.0.0:80").page_address(), "http://127.0.0.1:80/?t=secret");
        assert_eq!(guard("[::1]:80").page_address(), "http://[::1]:80/?t=secret");
    }

    #[test]
    fn a_token_is_the_whole_of_it() {
        let token = Token("secret".into());
        assert!(token.is("secret"));
        for guess in ["", "secre", "secrets", "Secret"] {
            assert!(!token.is(guess), "{guess}");
        }
        assert_ne!(Token::random(), Token::random());
        assert_eq!(Token::random().text().len(), 32);
        assert!(!format!("{token:?}").contains("secret"));
    }
}
