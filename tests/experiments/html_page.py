"""What a browser would see of an HTML page."""

from html.parser import HTMLParser

VOID = {"meta", "br", "wbr", "img"}


class Page(HTMLParser):
    """What a browser would see: texts, ids, links, and tags that do not match."""

    def __init__(self, text):
        super().__init__()
        self.texts, self.ids, self.links, self.open, self.wrong = [], [], [], [], []
        self.feed(text)
        self.text = " ".join(" ".join(self.texts).split())

    def handle_starttag(self, tag, attributes):
        if tag not in VOID:
            self.open.append(tag)
        for name, value in attributes:
            if name == "id":
                self.ids.append(value)
            if name in ("href", "src", "xlink:href"):
                self.links.append(value)

    def handle_startendtag(self, tag, attributes):
        self.handle_starttag(tag, attributes)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag):
        if not self.open or self.open.pop() != tag:
            self.wrong.append(tag)

    def handle_data(self, data):
        if self.open and self.open[-1] not in ("style", "script"):
            self.texts.append(data)
