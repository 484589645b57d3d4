"""Opens reports in a headless browser as a reader would, phone and desktop, light and dark. Run by .ci/report.

    browse.py SCREENSHOTS REPORT…

For every report: no message on the console, no request but for the file itself, the replay moves when it is played and by its
slider, plots and distributions can be read, legends hide and show, keys work, nothing is wider than the screen, every verdict is seen,
labels of bounds stand beside their lines, without scripts there are still pictures, paper gets the light colours, and every picture is
left in SCREENSHOTS.
"""

import base64
import json
import pathlib
import sys
import time

from selenium import webdriver
from selenium.webdriver.chrome.service import Service
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys

SIZES = {"phone": (390, 844), "desktop": (1280, 900)}


def browser(chromium, driver):
    options = webdriver.ChromeOptions()
    options.binary_location = chromium
    # As root, in a container, without a graphics card.
    for argument in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
                     "--disable-background-networking"):
        options.add_argument(argument)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    found = webdriver.Chrome(options=options, service=Service(driver))
    found.set_page_load_timeout(30)
    found.set_script_timeout(30)
    return found


# Notes, on each canvas, where dotted lines across and labels with a colon are drawn.
WATCH = """(() => {
    const context = CanvasRenderingContext2D.prototype;
    const { clearRect, lineTo, moveTo, fillText } = context;
    const of = (canvas) => (canvas.seen ||= { lines: [], labels: [] });
    context.clearRect = function (...a) { this.canvas.seen = undefined; return clearRect.apply(this, a); };
    context.moveTo = function (x, y) { this.from = [x, y]; return moveTo.call(this, x, y); };
    context.lineTo = function (x, y) {
        if (String(this.getLineDash()) === "2,3" && this.from && this.from[1] === y) of(this.canvas).lines.push(y);
        return lineTo.call(this, x, y);
    };
    context.fillText = function (text, x, y) {
        if (text.includes(": ")) of(this.canvas).labels.push([text, x - this.measureText(text).width, x, y]);
        return fillText.call(this, text, x, y);
    };
})()"""
# Of every still picture: its size, and of each label with a colon how many lines of its own colour run through the letters.
STILL = """return [...document.querySelectorAll("noscript svg")].map((svg) => {
    const { width, height } = svg.getBoundingClientRect();
    const lines = [...svg.querySelectorAll("polyline[stroke-dasharray]")].map((line) => [line.getAttribute("stroke"), line.getBoundingClientRect()])
        .filter(([, box]) => box.height < 2 && box.width > width / 2);
    const labels = [...svg.querySelectorAll("text")].filter((text) => text.textContent.includes(": "));
    const struck = labels.map((text) => [text.textContent, text.getBoundingClientRect()])
        .filter(([, box]) => lines.some(([, line]) => Math.abs(line.top + line.height / 2 - (box.top + box.height / 2)) < 0.2 * box.height))
        .map(([text]) => text);
    return { width, height, curves: svg.querySelectorAll("polyline").length, labels: labels.length, struck };
})"""


class Reader:
    """A browser of one size and colour scheme with one report open."""

    def __init__(self, chrome, report, size, scheme, still=False):
        self.chrome, self.report, self.size = chrome, report, size
        self.name = f"{report.parent.name}-{size}-{scheme}"
        width, height = SIZES[size]
        metrics = {"width": width, "height": height, "deviceScaleFactor": 2 if size == "phone" else 1,
                   "mobile": size == "phone"}
        chrome.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", metrics)
        chrome.execute_cdp_cmd("Emulation.setTouchEmulationEnabled", {"enabled": size == "phone"})
        features = [{"name": "prefers-color-scheme", "value": scheme},
                    {"name": "prefers-reduced-motion", "value": "reduce" if still else "no-preference"}]
        chrome.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": features})
        chrome.get_log("performance"), chrome.get_log("browser")
        chrome.get(report.resolve().as_uri())
        self.frames()

    def script(self, text, *arguments):
        return self.chrome.execute_script(text, *arguments)

    def expect(self, holds, what):
        if not holds:
            raise SystemExit(f"error: {self.name}: {what}")

    def frames(self):
        """Waits until the page is drawn."""
        self.chrome.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(arguments[0]))")

    def element(self, selector):
        return self.chrome.find_element(By.CSS_SELECTOR, selector)

    def seen(self, selector):
        """The element, scrolled to."""
        element = self.element(selector)
        self.script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", element)
        return element

    def picture(self, selector="canvas.stage"):
        """What a canvas shows."""
        self.frames()
        return self.script("return document.querySelector(arguments[0]).toDataURL()", selector)

    def time(self):
        return float(self.script("return document.querySelector('.now').textContent").split()[0])

    def quiet(self):
        """Nothing on the console, and no request."""
        log = self.chrome.get_log("browser")
        self.expect(not log, f"on the console: {log}")
        requested = []
        for entry in self.chrome.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] == "Network.requestWillBeSent":
                requested.append(message["params"]["request"]["url"])
        self.expect(requested == [self.report.resolve().as_uri()], f"requested {requested}")

    def fits(self):
        # A phone's browser widens its window to what a page asks for: the screen counts.
        width, screen = self.script("return document.documentElement.scrollWidth"), SIZES[self.size][0]
        self.expect(width <= screen, f"the page is {width} pixels wide on a screen of {screen}")
        small = self.script("""return [...document.querySelectorAll("button, select, input")].filter((e) => e.offsetParent)
            .filter((e) => e.offsetHeight < 24).map((e) => e.outerHTML)""")
        self.expect(not small, f"too small for a finger: {small[:3]}")

    def verdicts(self):
        """Every verdict of a table is on the screen, whole, and nothing lies on it."""
        lost = self.script("""return [...document.querySelectorAll("td .verdict")].filter((verdict) => {
            verdict.scrollIntoView({ block: "center", behavior: "instant" });
            const { left, right, top, bottom, width, height } = verdict.getBoundingClientRect();
            const frame = verdict.closest(".scroll").getBoundingClientRect();
            const on = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
            return !(width > 5 && height > 5 && left >= frame.left && right <= frame.right && on === verdict);
        }).map((verdict) => verdict.closest("tr").textContent)""")
        self.expect(not lost, f"verdicts that are not seen: {lost[:3]}")
        wide = self.script("""const claims = document.querySelector("#claims ~ .scroll");
            return claims ? claims.scrollWidth - claims.clientWidth : 0""")
        self.expect(wide <= 0, f"the claims are {wide} pixels wider than their frame")

    def labels(self):
        """No label of a bound is struck through by its line or written on another label."""
        seen = self.script("return [...document.querySelectorAll('figure[data-plot] canvas')].map((canvas) => canvas.seen).filter(Boolean)")
        count = 0
        for labels, lines in ((plot["labels"], plot["lines"]) for plot in seen):
            count += len(labels)
            for place, (text, left, right, y) in enumerate(labels):
                # Beside its own line: letters reach five pixels up and down from their middle.
                self.expect(any(7 <= abs(line - y) <= 11 for line in lines), f"{text!r} stands at no line")
                for other, start, end, at in labels[:place]:
                    self.expect(abs(at - y) > 11 or end < left or right < start, f"{text!r} is written on {other!r}")
        return count

    def early(self):
        """A pointer that the page is opened or scrolled under reads plots that are not drawn yet, and so do keys."""
        self.script("""for (const box of document.querySelectorAll(".chart")) {
            const { left, top } = box.getBoundingClientRect();
            box.dispatchEvent(new PointerEvent("pointermove", { clientX: left + 99, clientY: top + 99 }));
            box.dispatchEvent(new KeyboardEvent("keydown", { key: "ArrowRight" }));
            box.dispatchEvent(new PointerEvent("pointerleave"));
        }""")

    def drawn(self):
        """Every plot that was scrolled to shows something."""
        boxes = self.chrome.find_elements(By.CSS_SELECTOR, ".chart")
        for place, box in enumerate(boxes):
            self.script("arguments[0].scrollIntoView({block: 'center', behavior: 'instant'})", box)
            # The observer that says which plots are seen comes after the frame.
            for _ in range(50):
                self.frames()
                canvas = self.script("const c = arguments[0].firstChild; return [c.width, c.height]", box)
                if canvas != [300, 150]:
                    break
            used = self.script("""const c = arguments[0].firstChild;
                return c.getContext("2d").getImageData(0, 0, c.width, c.height).data.some((byte) => byte > 0)""", box)
            self.expect(used and canvas != [300, 150], f"plot {place} is empty")
        return len(boxes)

    def replay(self):
        """It moves when it is played and by its slider, and stands still otherwise."""
        first, start = self.picture(), self.time()
        self.frames()
        self.expect(self.picture() == first and self.time() == start, "the replay moves unasked")
        self.seen(".play").click()
        until = time.monotonic() + 10
        while self.time() < start + 0.3 and time.monotonic() < until:
            self.frames()
        self.seen(".play").click()
        # A busy machine takes its time to answer a click.
        while "Pause" in self.element(".play").text and time.monotonic() < until + 10:
            self.frames()
        played, at = self.picture(), self.time()
        self.expect(played != first and at >= start + 0.3, f"the replay does not play: from {start} s to {at} s in 10 s")
        self.frames()
        self.expect(self.time() == at, "the replay does not pause")
        self.script("""const slider = document.querySelector("input.time");
            slider.value = 0.6 * slider.max; slider.dispatchEvent(new Event("input"))""")
        end = float(self.script("return document.querySelector('input.time').max"))
        self.expect(abs(self.time() - 0.6 * end) < 0.02 and self.picture() != played, "the slider moves nothing")
        orbited = self.picture()
        ActionChains(self.chrome).click_and_hold(self.seen("canvas.stage")).move_by_offset(60, 20).release().perform()
        self.expect(self.picture() != orbited, "dragging does not orbit")

    def has(self, selector):
        return bool(self.chrome.find_elements(By.CSS_SELECTOR, selector))

    def distribution(self):
        """A distribution is read by its keys, and shown as a share on demand."""
        chart = self.seen("figure[data-distribution] .chart")
        for _ in range(50):
            self.frames()
            if self.script("return arguments[0].firstChild.width !== 300", chart):
                break
        bars = self.picture("figure[data-distribution] canvas")
        self.script("arguments[0].focus()", chart)
        ActionChains(self.chrome).send_keys(Keys.ARROW_RIGHT * 8).perform()
        read = self.element("figure[data-distribution] .reading").text
        self.expect("% up to" in read, f"a distribution reads {read!r}")
        self.element("figure[data-distribution] .fit").click()
        self.expect(self.picture("figure[data-distribution] canvas") != bars, "the share looks like the bars")

    def keyboard(self):
        """From the top by Tab alone: the skip link, then replay and plots by their keys."""
        keys = lambda *pressed: ActionChains(self.chrome).send_keys(*pressed).perform()
        focused = lambda: self.script("return document.activeElement.className || document.activeElement.tagName")
        keys(Keys.TAB)
        self.expect(focused() == "skip", f"the first Tab leads to {focused()}")
        for _ in range(30):
            if focused() == "stage":
                break
            keys(Keys.TAB)
        self.expect(focused() == "stage", "Tab does not reach the replay")
        for key, what in ((Keys.ARROW_LEFT, "orbit"), ("+", "come closer"), ("f", "follow"), ("r", "reset")):
            before = self.picture()
            keys(key)
            self.expect(self.picture() != before, f"no key to {what}")
        keys(Keys.HOME)
        self.expect(self.time() == 0, "Home does not lead to the start")
        keys(".")
        self.expect(0 < self.time() < 1, "a full stop does not step")
        keys(Keys.SPACE)
        until = time.monotonic() + 10
        while self.time() < 0.05 and time.monotonic() < until:
            self.frames()
        keys(Keys.SPACE)
        self.expect(self.time() >= 0.05, "Space does not play")
        for _ in range(80):
            if focused() == "chart":
                break
            keys(Keys.TAB)
        self.expect(focused() == "chart", "Tab does not reach a plot")
        # However long a busy machine has played.
        keys(Keys.HOME)
        before, shown = self.time(), self.element(".range").text
        keys(Keys.ARROW_RIGHT)
        self.expect(self.time() > before, "the cursor of a plot does not move")
        keys("+")
        self.expect(self.element(".range").text != shown, "no key zooms")
        zoomed = self.element(".range").text
        keys(Keys.PAGE_DOWN)
        self.expect(self.element(".range").text != zoomed, "no key pans")
        keys("0")
        self.expect(self.element(".range").text == shown, "0 does not show all")
        time.sleep(0.5)
        said = self.element("#live").get_attribute("textContent")
        self.expect("x " in said and " m" in said, f"a screen reader gets nothing: {said!r}")

    def toggles(self):
        """A name in a legend hides its curve, and shows it again."""
        for figure in ("figure[data-plot]", "figure[data-distribution]"):
            if not self.has(f"{figure} .legend button"):
                continue
            self.seen(f"{figure} .chart")
            for _ in range(50):
                self.frames()
                if self.script("return document.querySelector(arguments[0]).width !== 300", f"{figure} canvas"):
                    break
            whole, name = self.picture(f"{figure} canvas"), self.seen(f"{figure} .legend button")
            name.click()
            hidden = self.picture(f"{figure} canvas")
            self.expect(hidden != whole and name.get_attribute("aria-pressed") == "false", f"{figure}: no curve is hidden")
            name.click()
            self.expect(self.picture(f"{figure} canvas") == whole, f"{figure}: the curve does not come back")

    def pointer(self):
        """A mouse reads values, and zooms by dragging."""
        chart = self.seen(".chart")
        reading = lambda: self.element(".reading").text
        ActionChains(self.chrome).move_to_element_with_offset(chart, 0, 0).perform()
        before = reading()
        ActionChains(self.chrome).move_to_element_with_offset(chart, 80, 0).perform()
        self.expect(reading() != before and reading().endswith(" m"), f"the cursor reads {before!r}, then {reading()!r}")
        shown = self.element(".range").text
        ActionChains(self.chrome).click_and_hold(chart).move_by_offset(60, 0).release().perform()
        self.expect(self.element(".range").text != shown, "dragging does not zoom")
        ActionChains(self.chrome).double_click(chart).perform()
        self.expect(self.element(".range").text == shown, "a double click does not show all")

    def shoot(self, folder, whole=False, scripts=True):
        if scripts:
            self.script("scrollTo({top: 0, behavior: 'instant'})")
            self.frames()
        asked = {"format": "png", "captureBeyondViewport": whole}
        if whole:
            height = self.script("return document.documentElement.scrollHeight")
            asked["clip"] = {"x": 0, "y": 0, "width": SIZES[self.size][0], "height": height, "scale": 1}
        shot = self.chrome.execute_cdp_cmd("Page.captureScreenshot", asked)
        (folder / f"{self.name}.png").write_bytes(base64.b64decode(shot["data"]))

    def still(self, folder):
        """Without scripts every plot and the replay are pictures, and labels stand beside their lines."""
        figures = self.script("return document.querySelectorAll('figure[data-plot], [data-replay]').length")
        self.chrome.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": True})
        try:
            self.chrome.get(self.report.resolve().as_uri())
            pictures = self.script(STILL)
            self.name += "-still"
            self.expect(len(pictures) == figures, f"{len(pictures)} still pictures of {figures}")
            for picture in pictures:
                self.expect(picture["width"] > 200 and picture["height"] > 100 and picture["curves"] > 5, f"a still picture: {picture}")
                self.expect(not picture["struck"], f"struck through: {picture['struck']}")
            self.shoot(folder, whole=True, scripts=False)
        finally:
            self.chrome.execute_cdp_cmd("Emulation.setScriptExecutionDisabled", {"value": False})
        return sum(picture["labels"] for picture in pictures)

    def paper(self, folder):
        """Printed it is light whatever the screen, without controls, and the figures are there."""
        printed = self.chrome.execute_cdp_cmd("Page.printToPDF", {"printBackground": True, "paperWidth": 8.27, "paperHeight": 11.69})
        document = base64.b64decode(printed["data"])
        (folder / f"{self.name}.pdf").write_bytes(document)
        pages = document.count(b"/Type /Page\n") + document.count(b"/Type /Page ")
        self.expect(document[:5] == b"%PDF-" and len(document) > 50_000, f"paper: {len(document)} bytes")
        self.expect(2 <= pages <= 20, f"paper: {pages} pages")
        self.chrome.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": [
            {"name": "prefers-color-scheme", "value": "dark"}]})
        self.script("dispatchEvent(new Event('beforeprint'))")
        look = self.script("""const hidden = (s) => [...document.querySelectorAll(s)].every((e) => getComputedStyle(e).display === "none");
            return [getComputedStyle(document.body).backgroundColor, hidden("nav"), hidden(".transport"), hidden(".tools"),
                getComputedStyle(document.documentElement).getPropertyValue("--ink").trim()]""")
        self.script("dispatchEvent(new Event('afterprint'))")
        self.expect(look == ["rgb(255, 255, 255)", True, True, True, "#22272b"], f"paper looks like the screen: {look}")


def main():
    chromium, driver, folder, *reports = sys.argv[1:]
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    chrome = browser(chromium, driver)
    chrome.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", {"source": WATCH})
    try:
        for report in map(pathlib.Path, reports):
            started, plots, labels = time.monotonic(), 0, 0
            for size in SIZES:
                for scheme in ("light", "dark"):
                    reader = Reader(chrome, report, size, scheme)
                    if (size, scheme) == ("phone", "light"):
                        reader.early()
                    reader.fits()
                    reader.verdicts()
                    if reader.has("canvas.stage"):
                        if size == "desktop":
                            reader.keyboard()
                        reader.replay()
                    if reader.has("figure[data-plot]") and size == "desktop":
                        reader.pointer()
                    reader.toggles()
                    if reader.has("figure[data-distribution]"):
                        reader.distribution()
                    if (size, scheme) in (("desktop", "light"), ("phone", "dark")):
                        plots, labels = reader.drawn(), reader.labels()
                    reader.shoot(folder, whole=True)
                    reader.quiet()
            reader.paper(folder)
            stills = Reader(chrome, report, "phone", "light").still(folder)
            reader.expect((stills > 0) == (labels > 0), f"{labels} labels of bounds, {stills} without scripts")
            still = Reader(chrome, report, "desktop", "light", still=True)
            still.expect(still.script("return getComputedStyle(document.documentElement).scrollBehavior") == "auto",
                         "it scrolls smoothly despite prefers-reduced-motion")
            still.quiet()
            print(f"{report}: {plots} plots, {labels} labels of bounds, {time.monotonic() - started:.1f} s")
    finally:
        chrome.quit()


main()
