;;; What a person does in Emacs, in batch: our mode by itself, and eglot with the built server.  -*- lexical-binding: t -*-
;;
;; Usage: emacs --batch -l emacs.el, in an empty folder, with RTC and ROOT in the environment.

(require 'cl-lib)
(load (expand-file-name "init" (file-name-directory load-file-name)) nil t)
(defvar root (getenv "ROOT"))
(setq eglot-sync-connect t)

(defconst scene "// A ball on a floor.
param size: length = 50cm in 10cm to 1m
material paint = diffuse { color: #d94f30 }
sphere ball { at: (0, size, 0), radius: size, material: paint }
plane {}
light { at: (2, 3, 2)m, power: 60W }
camera { from: (0, 1, 4)m, look: ball }
")

(defun tell (what) (princ (format "  emacs: %s\n" what)))

(defun check (holds what)
  (unless holds (error "%s" what)))

(defun wait (what holds)
  (let ((end (+ (float-time) 20)) value)
    (while (not (or (setq value (funcall holds)) (> (float-time) end)))
      (accept-process-output nil 0.05))
    (check value (format "waited in vain until %s" what))))

(defun change (old new)
  "Replace OLD by NEW, as typing does, and tell the server."
  (goto-char (point-min))
  (search-forward old)
  (replace-match new t t)
  (eglot--signal-textDocument/didChange)
  (goto-char (match-beginning 0)))

(defun face (place)
  (goto-char (point-min))
  (search-forward place)
  (get-text-property (match-beginning 0) 'face))

(with-temp-file "scene.rt" (insert scene))
(find-file "scene.rt")
(check (eq major-mode 'rt-mode) (format "the mode is %s" major-mode))
(font-lock-ensure)
(dolist (wanted '(("ball on" font-lock-comment-face)
                  ("param" font-lock-keyword-face)
                  ("length" font-lock-type-face)
                  ("diffuse" font-lock-type-face)
                  ("color" font-lock-variable-name-face)
                  ("#d94f30" font-lock-constant-face)
                  ("50cm" font-lock-constant-face)))
  (check (eq (face (car wanted)) (cadr wanted)) (format "%s is %s" (car wanted) (face (car wanted)))))
(tell "words have their colours")

(let ((garden (expand-file-name "examples/garden/garden.rt" root)))
  (with-temp-buffer
    (insert-file-contents garden)
    (let ((written (buffer-string)))
      (rt-mode)
      (goto-char (point-min))
      (while (not (eobp)) (delete-horizontal-space) (forward-line))
      (indent-region (point-min) (point-max))
      (check (equal (buffer-string) written) (format "garden.rt is indented otherwise:\n%s" (buffer-string))))))
(tell "what is laid out is indented so")

(apply #'eglot--connect (eglot--guess-contact))
(check (eglot-current-server) "the server starts")
(check (eglot-managed-p) "the buffer is managed")
(flymake-mode 1)

(defun messages ()
  (flymake-start)
  (flymake-diagnostics))

(change "radius: size" "radius: 8deg")
(wait "the slip is told" #'messages)
(check (string-match-p "E0203\\|length" (flymake-diagnostic-text (car (messages))))
       (flymake-diagnostic-text (car (messages))))
(change "8deg" "size")
(wait "the message goes" (lambda () (null (messages))))
(tell "messages appear and go")

(change "plane {}" "plane { no")
(goto-char (point-min))
(search-forward "{ no")
(let* ((found (eglot-completion-at-point))
       (all (all-completions "no" (nth 2 found))))
  (check (cl-some (lambda (it) (string-match-p "normal" it)) all) (format "%S" all)))
(change "plane { no" "plane {}")
(tell "completion knows fields, in a broken statement too")

(goto-char (point-min))
(search-forward "radius")
(let ((answer (jsonrpc-request (eglot-current-server) :textDocument/hover (eglot--TextDocumentPositionParams))))
  (check (string-match-p "length" (format "%S" (plist-get answer :contents))) (format "%S" answer)))
(tell "hover tells what is there")

(goto-char (point-min))
(search-forward "material pai")
(eglot-rename "clay")
(check (string-match-p "material clay = \\(.\\|\n\\)*material: clay }" (buffer-string)) (buffer-string))
(tell "renaming reaches every use")

(change "plane {}" "plane   {  }")
(eglot-format-buffer)
(check (string-match-p "^plane {}$" (buffer-string)) (buffer-string))
(tell "the text is laid out")

(let (page)
  (cl-letf (((symbol-function 'browse-url) (lambda (address &rest _) (setq page address))))
    (rt-preview)
    (wait "the page opens" (lambda () page)))
  (check (string-match-p "\\`http://127\\.0\\.0\\.1:[0-9]+/[[:alnum:]]+/\\'" page) page))
(tell "the live preview serves the text, saved or not")

(save-window-excursion
  (goto-char (point-min))
  (let ((place '(:start (:line 3 :character 7) :end (:line 3 :character 7))))
    (eglot-handle-request (eglot-current-server) 'window/showDocument
                          :uri (plist-get (eglot--TextDocumentIdentifier) :uri) :selection place))
  (check (looking-at "ball { at") (buffer-substring (point) (line-end-position))))
(tell "a place that is clicked on in the preview is shown")

(save-buffer)
(eglot-shutdown (eglot-current-server))
(tell "the server ends when it is told to")
