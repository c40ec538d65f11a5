// For small screens: pictures open large, and tables that are wider than their box say so.
(() => {
  const large = document.getElementById("large");
  const place = document.getElementById("large-picture");
  for (const button of document.querySelectorAll(".enlarge")) {
    button.addEventListener("click", () => {
      place.replaceChildren(button.querySelector("img").cloneNode());
      large.showModal();
      place.scrollTo(0, 0);
    });
  }
  place.addEventListener("click", () => large.close());
  large.addEventListener("close", () => place.replaceChildren());

  const look = (box) => {
    const wide = box.scrollWidth > box.clientWidth + 1;
    box.classList.toggle("wide", wide);
    box.classList.toggle("end", wide && box.scrollLeft + box.clientWidth >= box.scrollWidth - 2);
  };
  const sized = new ResizeObserver((seen) => seen.forEach(({ target }) => look(target.closest(".scroll"))));
  for (const box of document.querySelectorAll(".scroll")) {
    sized.observe(box);
    sized.observe(box.querySelector("table"));
    box.addEventListener("scroll", () => look(box), { passive: true });
  }
})();
