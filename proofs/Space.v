(** * Vectors of space, and how they move

    Three components in one frame, whatever their unit; lengths, products, and
    derivatives in time. What [Direction], [Lemma1] and [SharpBound] share. *)

From Coq Require Import Reals Lra.
From Coquelicot Require Import Coquelicot.
Open Scope R_scope.

Record space := { x : R; y : R; z : R }.

Definition add (u v : space) : space := {| x := x u + x v; y := y u + y v; z := z u + z v |}.
Definition sub (u v : space) : space := {| x := x u - x v; y := y u - y v; z := z u - z v |}.
Definition scaled (k : R) (v : space) : space := {| x := k * x v; y := k * y v; z := k * z v |}.
Definition dot (u v : space) : R := x u * x v + y u * y v + z u * z v.
Definition cross (u v : space) : space :=
  {| x := y u * z v - z u * y v; y := z u * x v - x u * z v; z := x u * y v - y u * x v |}.
Definition square (v : space) : R := dot v v.
Definition length (v : space) : R := sqrt (square v).

Ltac components := unfold square, dot, cross, add, sub, scaled in *; cbn [x y z] in *.

Lemma same : forall u v, x u = x v -> y u = y v -> z u = z v -> u = v.
Proof. intros [a b c] [d e f]. cbn. now intros -> -> ->. Qed.

(** ** Lengths *)

Lemma squared : forall a : R, 0 <= a * a.
Proof. intros. apply Rle_0_sqr. Qed.

Lemma square_nonneg : forall v, 0 <= square v.
Proof. intros v. components. pose proof (squared (x v)). pose proof (squared (y v)). pose proof (squared (z v)). lra.
  Qed.

Lemma length_nonneg : forall v, 0 <= length v.
Proof. intros v. apply sqrt_pos. Qed.

Lemma length_squared : forall v, length v * length v = square v.
Proof. intros v. apply sqrt_def, square_nonneg. Qed.

Lemma below_by_squares : forall a b, 0 <= b -> a * a <= b * b -> a <= b.
Proof. intros a b Hb H. now apply Rsqr_incr_0_var. Qed.

Lemma squares_below : forall a b, 0 <= a -> a <= b -> a * a <= b * b.
Proof. intros a b Ha H. apply Rmult_le_compat; lra. Qed.

Lemma length_below : forall v b, 0 <= b -> square v <= b * b -> length v <= b.
Proof. intros v b Hb H. apply below_by_squares; [exact Hb|]. now rewrite length_squared. Qed.

Lemma square_below : forall v b, length v <= b -> square v <= b * b.
Proof. intros v b H. rewrite <- length_squared. now apply squares_below; [apply length_nonneg|]. Qed.

Lemma length_scaled : forall k v, length (scaled k v) = Rabs k * length v.
Proof.
  intros k v. unfold length. replace (square (scaled k v)) with ((k * k) * square v) by (components; ring).
  rewrite sqrt_mult_alt by apply squared. f_equal. apply sqrt_Rsqr_abs.
Qed.

Lemma cauchy_schwarz : forall u v, Rabs (dot u v) <= length u * length v.
Proof.
  intros u v. pose proof (length_nonneg u). pose proof (length_nonneg v).
  apply below_by_squares; [now apply Rmult_le_pos|].
  replace (Rabs (dot u v) * Rabs (dot u v)) with (dot u v * dot u v)
    by (rewrite <- Rabs_mult; symmetry; apply Rabs_pos_eq, squared).
  replace (length u * length v * (length u * length v)) with (square u * square v)
    by (rewrite <- (length_squared u), <- (length_squared v); ring).
  pose proof (square_nonneg (cross u v)). components. lra.
Qed.

Lemma triangle : forall u v, length (add u v) <= length u + length v.
Proof.
  intros u v. pose proof (length_nonneg u). pose proof (length_nonneg v).
  apply length_below; [lra|].
  pose proof (cauchy_schwarz u v) as Hcs. pose proof (Rle_abs (dot u v)).
  replace ((length u + length v) * (length u + length v))
    with (square u + square v + 2 * (length u * length v))
    by (rewrite <- (length_squared u), <- (length_squared v); ring).
  replace (square (add u v)) with (square u + square v + 2 * dot u v) by (components; ring). lra.
Qed.

Lemma triangle_sub : forall u v, length (sub u v) <= length u + length v.
Proof.
  intros u v. replace (sub u v) with (add u (scaled (-1) v)) by (apply same; components; ring).
  eapply Rle_trans; [apply triangle|]. rewrite length_scaled, Rabs_left by lra. lra.
Qed.

Lemma length_cross : forall u v, length (cross u v) <= length u * length v.
Proof.
  intros u v. apply length_below; [apply Rmult_le_pos; apply length_nonneg|].
  replace (length u * length v * (length u * length v)) with (square u * square v)
    by (rewrite <- (length_squared u), <- (length_squared v); ring).
  pose proof (squared (dot u v)). components. lra.
Qed.

(** In the frame of two orthogonal unit vectors and their product a scalar
    product is that of the components. *)
Lemma in_a_frame : forall a b v w, square a = 1 -> square b = 1 -> dot a b = 0 ->
  dot v w = dot a v * dot a w + dot b v * dot b w + dot (cross a b) v * dot (cross a b) w.
Proof.
  intros a b v w Ha Hb Hab.
  assert (Hgram : dot (cross a b) v * dot (cross a b) w
    = square a * (square b * dot v w - dot b v * dot b w)
      - dot a b * (dot a b * dot v w - dot b v * dot a w)
      + dot a v * (dot a b * dot b w - square b * dot a w)) by (components; ring).
  rewrite Hgram, Ha, Hb, Hab. ring.
Qed.

(** ** Derivatives *)

Definition moves (v : R -> space) (t : R) (d : space) : Prop :=
  is_derive (fun s => x (v s)) t (x d) /\ is_derive (fun s => y (v s)) t (y d) /\
  is_derive (fun s => z (v s)) t (z d).

Lemma derive_product : forall (f g : R -> R) (t a b : R), is_derive f t a -> is_derive g t b ->
  is_derive (fun s => f s * g s) t (a * g t + f t * b).
Proof. intros f g t a b Hf Hg. apply is_derive_Reals in Hf, Hg. apply is_derive_Reals.
  now apply derivable_pt_lim_mult. Qed.

Lemma derive_sum : forall (f g : R -> R) (t a b : R), is_derive f t a -> is_derive g t b ->
  is_derive (fun s => f s + g s) t (a + b).
Proof. intros f g t a b Hf Hg. apply is_derive_Reals in Hf, Hg. apply is_derive_Reals.
  now apply derivable_pt_lim_plus. Qed.

Lemma derive_difference : forall (f g : R -> R) (t a b : R), is_derive f t a -> is_derive g t b ->
  is_derive (fun s => f s - g s) t (a - b).
Proof. intros f g t a b Hf Hg. apply is_derive_Reals in Hf, Hg. apply is_derive_Reals.
  now apply derivable_pt_lim_minus. Qed.

Lemma derive_opposite : forall (f : R -> R) (s l : R), is_derive f s l -> is_derive (fun t => - f t) s (- l).
Proof. intros f s l H. apply is_derive_Reals in H. apply is_derive_Reals. now apply derivable_pt_lim_opp. Qed.

Lemma derive_quotient : forall (f g : R -> R) (t a b : R), is_derive f t a -> is_derive g t b -> g t <> 0 ->
  is_derive (fun s => f s / g s) t ((a * g t - b * f t) / (g t * g t)).
Proof. intros f g t a b Hf Hg H. apply is_derive_Reals in Hf, Hg. apply is_derive_Reals.
  now apply derivable_pt_lim_div. Qed.

Lemma derive_constant : forall c t : R, is_derive (fun _ : R => c) t 0.
Proof. intros c t. apply is_derive_Reals, derivable_pt_lim_const. Qed.

Lemma derive_as : forall (f : R -> R) (t a b : R), is_derive f t a -> a = b -> is_derive f t b.
Proof. now intros f t a b H <-. Qed.

Lemma moves_as : forall v t d e, moves v t d -> d = e -> moves v t e.
Proof. now intros v t d e H <-. Qed.

Lemma moves_dot : forall u v t d e, moves u t d -> moves v t e ->
  is_derive (fun s => dot (u s) (v s)) t (dot d (v t) + dot (u t) e).
Proof.
  intros u v t d e (Hx & Hy & Hz) (Kx & Ky & Kz). unfold dot. eapply derive_as.
  - exact (derive_sum _ _ _ _ _ (derive_sum _ _ _ _ _ (derive_product _ _ _ _ _ Hx Kx)
      (derive_product _ _ _ _ _ Hy Ky)) (derive_product _ _ _ _ _ Hz Kz)).
  - cbn. ring.
Qed.

Lemma moves_add : forall u v t d e, moves u t d -> moves v t e ->
  moves (fun s => add (u s) (v s)) t (add d e).
Proof. intros u v t d e (Hx & Hy & Hz) (Kx & Ky & Kz). exact (conj (derive_sum _ _ _ _ _ Hx Kx)
  (conj (derive_sum _ _ _ _ _ Hy Ky) (derive_sum _ _ _ _ _ Hz Kz))). Qed.

Lemma moves_sub : forall u v t d e, moves u t d -> moves v t e ->
  moves (fun s => sub (u s) (v s)) t (sub d e).
Proof. intros u v t d e (Hx & Hy & Hz) (Kx & Ky & Kz). exact (conj (derive_difference _ _ _ _ _ Hx Kx)
  (conj (derive_difference _ _ _ _ _ Hy Ky) (derive_difference _ _ _ _ _ Hz Kz))). Qed.

Lemma moves_scaled : forall (k : R -> R) v t l d, is_derive k t l -> moves v t d ->
  moves (fun s => scaled (k s) (v s)) t (add (scaled l (v t)) (scaled (k t) d)).
Proof. intros k v t l d Hk (Hx & Hy & Hz). exact (conj (derive_product _ _ _ _ _ Hk Hx)
  (conj (derive_product _ _ _ _ _ Hk Hy) (derive_product _ _ _ _ _ Hk Hz))). Qed.

Lemma moves_cross : forall u v t d e, moves u t d -> moves v t e ->
  moves (fun s => cross (u s) (v s)) t (add (cross d (v t)) (cross (u t) e)).
Proof.
  intros u v t d e (Hx & Hy & Hz) (Kx & Ky & Kz).
  assert (Hminor : forall (f g h k : R -> R) a b c e', is_derive f t a -> is_derive g t b -> is_derive h t c ->
    is_derive k t e' -> is_derive (fun s => f s * g s - h s * k s) t ((a * g t - c * k t) + (f t * b - h t * e'))).
  { intros f g h k a b c e' Hf Hg Hh Hk. eapply derive_as.
    - exact (derive_difference _ _ _ _ _ (derive_product _ _ _ _ _ Hf Hg) (derive_product _ _ _ _ _ Hh Hk)).
    - cbn. ring. }
  exact (conj (Hminor _ _ _ _ _ _ _ _ Hy Kz Hz Ky)
    (conj (Hminor _ _ _ _ _ _ _ _ Hz Kx Hx Kz) (Hminor _ _ _ _ _ _ _ _ Hx Ky Hy Kx))).
Qed.
