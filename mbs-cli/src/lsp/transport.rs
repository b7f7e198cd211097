//! Messages over standard input and output: `Content-Length`, an empty line, JSON.

use std::io::{self, BufRead, Read, Write};

use lsp_server::Message;

/// Longer messages are passed over: no mechanism may be so long.
const LONGEST: u64 = 1 << 28;

/// What was read.
pub(super) enum Incoming {
    Message(Message),
    /// Something that is no message; the next one may be.
    Garbage(String),
    /// There is nothing more.
    End,
}

/// The next message; what is none does not keep from reading on.
pub(super) fn read(input: &mut impl BufRead) -> Incoming {
    let length = match length(input) {
        Ok(Some(length)) => length,
        Ok(None) => return Incoming::End,
        Err(reason) => return Incoming::Garbage(reason),
    };
    if length > LONGEST {
        let passed = io::copy(&mut input.take(length), &mut io::sink());
        return match passed {
            Ok(passed) if passed == length => Incoming::Garbage(format!("a message of {length} bytes is too long")),
            _ => Incoming::End,
        };
    }
    let mut content = Vec::new();
    match input.take(length).read_to_end(&mut content) {
        Ok(read) if read as u64 == length => {}
        _ => return Incoming::End,
    }
    match serde_json::from_slice(&content) {
        Ok(message) => Incoming::Message(message),
        Err(error) => Incoming::Garbage(format!("a message cannot be read: {error}")),
    }
}

/// The header up to the empty line; nothing where the input ends.
fn length(input: &mut impl BufRead) -> Result<Option<u64>, String> {
    const LONGEST_LINE: u64 = 4096;
    let mut length = None;
    loop {
        let mut line = Vec::new();
        match input.take(LONGEST_LINE).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return Ok(None),
            Ok(_) => {}
        }
        let line = String::from_utf8_lossy(&line);
        let line = line.trim();
        if line.is_empty() {
            return length.map(Some).ok_or_else(|| "a message has no length".to_string());
        }
        match line.split_once(':') {
            Some((name, value)) if name.eq_ignore_ascii_case("content-length") => {
                length = Some(value.trim().parse().map_err(|_| format!("`{}` is no length", value.trim()))?);
            }
            // Other fields say nothing that is needed.
            Some(_) => {}
            None => return Err(format!("`{}` is no header", line.chars().take(80).collect::<String>())),
        }
    }
}

/// Writes a message; whether somebody reads.
pub(super) fn write(output: &mut impl Write, message: &Message) -> bool {
    message.write(output).is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &[u8]) -> Vec<String> {
        let mut input = io::BufReader::new(text);
        let mut found = Vec::new();
        loop {
            match read(&mut input) {
                Incoming::Message(Message::Request(request)) => found.push(request.method),
                Incoming::Message(Message::Notification(notification)) => found.push(notification.method),
                Incoming::Message(Message::Response(_)) => found.push("response".to_string()),
                Incoming::Garbage(reason) => found.push(format!("! {reason}")),
                Incoming::End => return found,
            }
        }
    }

    fn framed(json: &str) -> String {
        format!("Content-Length: {}\r\n\r\n{json}", json.len())
    }

    #[test]
    fn garbage_is_passed_over() {
        let good = framed(r#"{"jsonrpc":"2.0","method":"a"}"#);
        let check = |before: &str, count: usize| {
            let found = all(format!("{before}{good}").as_bytes());
            assert_eq!(found.last().map(String::as_str), Some("a"), "{before}: {found:?}");
            assert_eq!(found.len(), count, "{before}: {found:?}");
        };
        check("", 1);
        check(&framed("{"), 2);
        check(&framed("[1, 2]"), 2);
        check(&framed(r#"{"jsonrpc":"2.0"}"#), 2);
        check("Content-Length: 4\r\nContent-Type: x\r\n\r\nnull", 2);
        check("nonsense\r\n", 2);
        check("Content-Length: -1\r\n", 2);
        check("\r\n", 2);
        check("content-length: 1\r\n\r\n\u{1}", 2);
        assert_eq!(all(b"Content-Length: 99999999999999\r\n\r\n{}"), [""; 0]);
        assert_eq!(all(b"Content-Length: 10\r\n\r\n{}"), [""; 0]);
    }
}
