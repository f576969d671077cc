//! A socket in place of a serial cable, for every system and across a network: one client at a time. One
//! that has said nothing for a while gives way to the next; any other is told that the robot is busy, by a
//! closed connection.

use std::io::{self, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

/// The robot's end of a socket.
#[derive(Debug)]
pub struct TcpPort {
    listener: TcpListener,
    client: Option<TcpStream>,
    /// When the client last said anything.
    heard: Option<Instant>,
}

/// A client that is silent for this long is gone, whatever its network says: one that drives speaks every
/// 20 ms.
const SILENCE: Duration = Duration::from_secs(3);

impl TcpPort {
    /// Waits for clients at `address`.
    ///
    /// # Errors
    /// What the system says, for instance `AddrInUse`.
    pub fn listen(address: impl ToSocketAddrs) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        Ok(Self { listener, client: None, heard: None })
    }

    /// Where clients find it.
    ///
    /// # Errors
    /// What the system says.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }

    fn client(&mut self) -> io::Result<&mut TcpStream> {
        if !self.is_served() {
            match self.listener.accept() {
                Ok((client, _)) => {
                    client.set_nonblocking(true)?;
                    client.set_nodelay(true)?;
                    (self.client, self.heard) = (Some(client), None);
                }
                Err(_) if self.client.is_some() => {}
                Err(error) => return Err(error),
            }
        }
        self.client.as_mut().ok_or_else(|| ErrorKind::WouldBlock.into())
    }

    fn is_served(&self) -> bool {
        self.heard.is_some_and(|heard| heard.elapsed() <= SILENCE)
    }

    /// A client that is gone makes room for the next.
    fn part<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        match result {
            Err(error) if error.kind() != ErrorKind::WouldBlock => {
                (self.client, self.heard) = (None, None);
                Err(ErrorKind::WouldBlock.into())
            }
            other => other,
        }
    }
}

impl Read for TcpPort {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let result = self.client()?.read(buffer);
        let result = result
            .and_then(|n| if n == 0 { Err(ErrorKind::ConnectionReset.into()) } else { Ok(n) });
        match &result {
            Ok(_) => self.heard = Some(Instant::now()),
            // Closed at once, and so told that somebody else is served.
            Err(error) if error.kind() == ErrorKind::WouldBlock && self.is_served() => {
                drop(self.listener.accept());
            }
            Err(_) => {}
        }
        self.part(result)
    }
}

impl Write for TcpPort {
    fn write(&mut self, buffer: &[u8]) -> io::Result<usize> {
        let result = self.client()?.write(buffer);
        self.part(result)
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn patiently<T>(mut attempt: impl FnMut() -> io::Result<T>) -> T {
        loop {
            match attempt() {
                Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::yield_now(),
                result => return result.unwrap(),
            }
        }
    }

    #[test]
    fn one_client_after_the_other() {
        let mut port = TcpPort::listen("127.0.0.1:0").unwrap();
        for byte in [1, 2] {
            let mut client = TcpStream::connect(port.address().unwrap()).unwrap();
            client.write_all(&[byte]).unwrap();
            let mut received = [0];
            patiently(|| port.read(&mut received));
            assert_eq!(received, [byte]);
            patiently(|| port.write(&[byte + 10]));
            client.read_exact(&mut received).unwrap();
            assert_eq!(received, [byte + 10]);
        }
    }

    #[test]
    fn a_client_that_says_nothing_gives_way() {
        let mut port = TcpPort::listen("127.0.0.1:0").unwrap();
        let silent = TcpStream::connect(port.address().unwrap()).unwrap();
        patiently(|| port.write(&[1]));
        let mut client = TcpStream::connect(port.address().unwrap()).unwrap();
        client.write_all(&[2]).unwrap();
        let mut received = [0];
        patiently(|| port.read(&mut received));
        assert_eq!(received, [2]);
        drop(silent);
        // Who has spoken is not disturbed by another, who is turned away.
        let mut other = TcpStream::connect(port.address().unwrap()).unwrap();
        assert_eq!(port.read(&mut received).unwrap_err().kind(), ErrorKind::WouldBlock);
        assert_eq!(other.read(&mut received).unwrap(), 0);
        client.write_all(&[3]).unwrap();
        patiently(|| port.read(&mut received));
        assert_eq!(received, [3]);
    }
}
