//! What other programs of the desktop do to a window: files dragged from a file manager, and a
//! new scale from the desktop's settings.

use std::path::Path;
use std::time::{Duration, Instant};

use x11rb::connection::Connection;
use x11rb::protocol::Event;
use x11rb::protocol::xproto::{
    Atom, CONFIGURE_NOTIFY_EVENT, ClientMessageEvent, ConfigureNotifyEvent, ConnectionExt as _,
    CreateWindowAux, EventMask, PropMode, SELECTION_NOTIFY_EVENT, SelectionNotifyEvent,
    SelectionRequestEvent, Window, WindowClass,
};
use x11rb::rust_connection::RustConnection;
use x11rb::wrapper::ConnectionExt as _;

/// Version of the drag-and-drop protocol that is spoken:
/// <https://www.freedesktop.org/wiki/Specifications/XDND/>.
const XDND_VERSION: u32 = 5;

/// Another program on the same display.
pub struct Desktop {
    connection: RustConnection,
    /// Where answers arrive.
    own: Window,
}

impl Desktop {
    pub fn connect(display: &str) -> Self {
        let (connection, screen) = RustConnection::connect(Some(display)).expect("the display");
        let root = connection.setup().roots[screen].root;
        let own = connection.generate_id().expect("a window's id");
        connection
            .create_window(
                x11rb::COPY_DEPTH_FROM_PARENT,
                own,
                root,
                0,
                0,
                1,
                1,
                0,
                WindowClass::INPUT_OUTPUT,
                x11rb::COPY_FROM_PARENT,
                &CreateWindowAux::new(),
            )
            .and_then(|_| connection.flush())
            .expect("a window");
        Self { connection, own }
    }

    /// Sets the desktop's resolution; 96 is scale 1. Programs look for the settings when they start,
    /// so the first resolution is set before.
    ///
    /// It is an XSETTINGS manager of one setting: winit hears of these alone, not of the resources
    /// of the root window (<https://specifications.freedesktop.org/xsettings-spec/>).
    pub fn set_dpi(&self, dpi: i32) {
        const NAME: &[u8; 7] = b"Xft/DPI";
        let serial = dpi as u32;
        // Little endian; the serial; one setting, an integer; its name, padded to four bytes.
        let mut bytes = vec![0, 0, 0, 0];
        bytes.extend(serial.to_le_bytes());
        bytes.extend(1_u32.to_le_bytes());
        bytes.extend([0, 0, NAME.len() as u8, 0]);
        bytes.extend(NAME);
        bytes.push(0);
        bytes.extend(serial.to_le_bytes());
        bytes.extend((dpi * 1024).to_le_bytes());
        let settings = self.atom("_XSETTINGS_SETTINGS");
        let manager = self.atom("_XSETTINGS_S0");
        self.connection
            .change_property8(PropMode::REPLACE, self.own, settings, settings, &bytes)
            .and_then(|_| {
                self.connection
                    .set_selection_owner(self.own, manager, x11rb::CURRENT_TIME)
            })
            .and_then(|_| self.connection.flush())
            .expect("the setting is set");
    }

    /// Tells a window where it is, as window managers do whenever they move it (ICCCM 4.1.5); here is
    /// none. winit looks for the scale of a window's monitor then.
    pub fn tell_place(&self, window: &str) {
        let window = window.parse().expect("a number");
        let geometry = self.connection.get_geometry(window).expect("the server");
        let place = geometry.reply().expect("a window");
        let event = ConfigureNotifyEvent {
            response_type: CONFIGURE_NOTIFY_EVENT,
            event: window,
            window,
            x: place.x,
            y: place.y,
            width: place.width,
            height: place.height,
            ..ConfigureNotifyEvent::default()
        };
        self.connection
            .send_event(false, window, EventMask::STRUCTURE_NOTIFY, event)
            .and_then(|_| self.connection.flush())
            .expect("the event is sent");
    }

    /// Drags a file over a window and lets it fall.
    pub fn drop_file(&self, window: &str, path: &Path) {
        let window = window.parse().expect("a number");
        let selection = self.atom("XdndSelection");
        let list = self.atom("text/uri-list");
        self.connection
            .set_selection_owner(self.own, selection, x11rb::CURRENT_TIME)
            .expect("the selection is owned");
        self.send(window, "XdndEnter", [XDND_VERSION << 24, list, 0, 0]);
        let copy = self.atom("XdndActionCopy");
        self.send(
            window,
            "XdndPosition",
            [0, (200 << 16) | 200, x11rb::CURRENT_TIME, copy],
        );
        let uri = format!("file://{}\r\n", path.display());
        self.wait("the file's name is asked for", |event| match event {
            Event::SelectionRequest(request) => {
                self.answer(request, uri.as_bytes());
                true
            }
            _ => false,
        });
        self.send(window, "XdndDrop", [0, x11rb::CURRENT_TIME, 0, 0]);
        let finished = self.atom("XdndFinished");
        self.wait("the drop is finished", |event| match event {
            Event::ClientMessage(message) if message.type_ == finished => {
                assert_eq!(message.data.as_data32()[1], 1, "the drop is refused");
                true
            }
            _ => false,
        });
    }

    fn atom(&self, name: &str) -> Atom {
        let cookie = self.connection.intern_atom(false, name.as_bytes());
        let reply = cookie.expect("the server").reply();
        reply.expect("an atom").atom
    }

    /// Sends a message of the drag from the own window.
    fn send(&self, window: Window, name: &str, [b, c, d, e]: [u32; 4]) {
        let data = [self.own, b, c, d, e];
        let message = ClientMessageEvent::new(32, window, self.atom(name), data);
        self.connection
            .send_event(false, window, EventMask::NO_EVENT, message)
            .and_then(|_| self.connection.flush())
            .expect("the message is sent");
    }

    fn answer(&self, request: &SelectionRequestEvent, bytes: &[u8]) {
        let notice = SelectionNotifyEvent {
            response_type: SELECTION_NOTIFY_EVENT,
            sequence: 0,
            time: request.time,
            requestor: request.requestor,
            selection: request.selection,
            target: request.target,
            property: request.property,
        };
        let (to, property) = (request.requestor, request.property);
        self.connection
            .change_property8(PropMode::REPLACE, to, property, request.target, bytes)
            .and_then(|_| {
                self.connection
                    .send_event(false, to, EventMask::NO_EVENT, notice)
            })
            .and_then(|_| self.connection.flush())
            .expect("the answer is sent");
    }

    fn wait(&self, what: &str, mut done: impl FnMut(&Event) -> bool) {
        let start = Instant::now();
        while start.elapsed() < Duration::from_secs(20) {
            match self.connection.poll_for_event().expect("the display") {
                Some(event) if done(&event) => return,
                Some(_) => {}
                None => std::thread::sleep(Duration::from_millis(10)),
            }
        }
        panic!("{what}: not seen");
    }
}
